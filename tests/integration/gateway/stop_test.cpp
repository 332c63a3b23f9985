// SPDX-License-Identifier: Apache-2.0
// A stop while 10,000 commands wait: how long until the user who pressed the button knows. Real broker,
// agent and firmware.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "running_gateway.hpp"
#include "tests/integration/agent/rig.hpp"
#include "tests/support/counted.hpp"

namespace asip::test {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kRounds = 5;
constexpr std::size_t kFewRounds = 8;  // more commands than the gateway keeps
constexpr int kCommands = 10'000;
constexpr milliseconds kPromise = 100ms;
constexpr milliseconds kSlack = 250ms;  // what a busy machine may need

class GatewayStop : public testing::Test {
  protected:
    void SetUp() override { ASSERT_TRUE(gateway_.becomes("uno1", "online")) << gateway_.process().errors(); }

    static std::string command(std::size_t round, int number) {
        return R"("write":[0,)" + std::to_string(number % 180) + R"(],"id":")" + std::to_string(round) + "-" +
               std::to_string(number) + "\"";
    }
    // As many commands of another client, of which each will be answered below `flood`.
    static void send_commands(BusProbe& flood, std::size_t round, int qos) {
        for (int i = 0; i < kCommands; ++i)
            flood.publish("asip/uno1/servo/in", "{" + command(round, i) + R"(,"reply_to":"flood"})", false,
                          qos);
    }
    milliseconds time_of(const std::function<void()>& what) {
        const auto begin = std::chrono::steady_clock::now();
        what();
        return std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - begin);
    }
    void expect_in_time(const char* what, std::vector<milliseconds> took) {
        std::sort(took.begin(), took.end());
        std::cout << "    " << what << ": median " << took[took.size() / 2].count() << " ms, maximum "
                  << took.back().count() << " ms of " << took.size() << '\n';
        EXPECT_LE(took[took.size() / 2], time_limit(kPromise + kSlack)) << what;
    }

    // As the configuration that is shipped has it: the broker queues what a client cannot take yet.
    MosquittoBroker broker_{{.extra_lines = {"max_queued_messages 0"}}};
    SimulatedUno uno_;
    Agent agent_{broker_, uno_.port()};
    /// Eighty thousand commands within a minute are more than one client may have kept.
    RunningGateway gateway_{
        broker_.address(),
        {"--config", settings_file("commands-per-second = 1000000\nmax-client-bytes = 1000000000\n")}};
};

TEST_F(GatewayStop, UnderTenThousandCommandsOfAnother_IsAnsweredAheadOfThem) {
    BusProbe flood(broker_.port(), {"flood"});
    std::vector<milliseconds> took;
    for (std::size_t round = 0; round < kRounds; ++round) {
        send_commands(flood, round, static_cast<int>(round % 2));
        took.push_back(time_of([&] {
            const auto stopped = post(
                gateway_.port(), round % 4 < 2 ? "/api/stop?once=true" : "/api/boards/uno1/stop?once=true");
            EXPECT_EQ(stopped.status, 200) << stopped.body;
        }));
        ASSERT_TRUE(wait_until([&] { return flood.count("flood") == kCommands * (round + 1); }, 60s))
            << flood.count("flood");
    }
    expect_in_time("POST of a stop, under 10,000 commands over MQTT", took);
}

TEST_F(GatewayStop, UnderTenThousandCommandsOfAWebSocket_IsAnsweredAheadOfThem) {
    std::vector<milliseconds> took;
    for (std::size_t round = 0; round < kFewRounds; ++round) {
        Socket socket(gateway_.port());
        std::atomic<int> answers = 0;
        std::thread reader([&] {
            while (answers < kCommands && !socket.message().empty())
                ++answers;
        });
        for (int i = 0; i < kCommands; ++i)
            socket.send(R"({"command":"uno1/servo",)" + command(round, i) + "}");
        took.push_back(time_of([&] {
            const auto stopped = post(gateway_.port(), "/api/stop?once=true");
            EXPECT_EQ(stopped.status, 200) << stopped.body;
        }));
        reader.join();
        EXPECT_EQ(answers, kCommands);
    }
    expect_in_time("POST of a stop, under 10,000 commands of a WebSocket", took);
}

// An answer waits behind all that the broker has for that connection: nothing is acknowledged there, and what
// is longer than an answer is not delivered.
TEST_F(GatewayStop, FloodWhereItsAnswersCome_CostsLittle) {
    constexpr std::size_t kFlood = 5000, kLarge = 50, kBytes = 200'000;
    BusProbe board(broker_.port(), {"asip/uno1/$stop"});
    const auto stop = [&] { return post(gateway_.port(), "/api/boards/uno1/stop?once=true").status; };
    ASSERT_EQ(stop(), 200);
    ASSERT_TRUE(board.wait_for("asip/uno1/$stop"));
    const std::string topic = nlohmann::json::parse(*board.last("asip/uno1/$stop"))["reply_to"];
    for (std::size_t i = 0; i < kFlood; ++i)
        board.publish(topic, "x");
    ASSERT_TRUE(wait_until([&] { return board.all_acknowledged(); }));
    for (std::size_t i = 0; i < kLarge; ++i)
        board.publish(topic, std::string(kBytes, 'x'));
    ASSERT_TRUE(wait_until([&] { return board.all_acknowledged(); }));
    EXPECT_EQ(stop(), 200);
    const auto process = std::to_string(gateway_.process().pid());
    EXPECT_LT(counted(process, "syscw"), kFlood / 2);
    EXPECT_LT(counted(process, "rchar"), kLarge * kBytes / 2);
}

TEST_F(GatewayStop, Asipctl_UnderTenThousandCommands_IsAnsweredAheadOfThem) {
    BusProbe flood(broker_.port(), {"flood"});
    std::vector<milliseconds> took;
    for (std::size_t round = 0; round < kRounds; ++round) {
        send_commands(flood, round, 0);
        took.push_back(time_of([&] {
            const auto stopped = run({ASIP_PROGRAMS "/asipctl", "stop", "uno1", "--once"},
                                     {{"ASIP_BROKER", broker_.address()}});
            EXPECT_EQ(stopped.status, 0) << stopped.errors;
        }));
        ASSERT_TRUE(wait_until([&] { return flood.count("flood") == kCommands * (round + 1); }, 60s))
            << flood.count("flood");
    }
    expect_in_time("asipctl stop, with its start, under 10,000 commands", took);
}

}  // namespace
}  // namespace asip::test
