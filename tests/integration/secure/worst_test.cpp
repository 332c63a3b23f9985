// SPDX-License-Identifier: Apache-2.0
// The worst of each kind that users of a secured bus can send, to each program. It stays alive below the
// memory limit of its systemd unit, and a stop goes through meanwhile.
#include <atomic>
#include <fstream>
#include <regex>
#include <thread>

#include "tests/integration/secure/running_bus.hpp"

namespace asip::test {
namespace {

constexpr std::size_t kMegabyte = std::size_t{1} << 20;
/// Below the packet limit of the broker, with topic and properties.
constexpr std::size_t kLargest = kMegabyte - 2000;

std::size_t memory_max_of(const std::string& unit) {
    std::ifstream file(ASIP_TEST_PACKAGING "/systemd/" + unit);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    std::smatch found;
    if (!std::regex_search(text, found, std::regex("\nMemoryMax=([0-9]+)([MG])\n")))
        throw std::runtime_error(unit + " has no MemoryMax");
    return std::stoul(found[1]) * kMegabyte * (found[2] == "G" ? 1024 : 1);
}

std::size_t peak_bytes(const ChildProcess& program) {
    std::ifstream status("/proc/" + std::to_string(program.pid()) + "/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::stoul(line.substr(6)) * 1024;
    return 0;
}

/// For how long a program was ready to run, and others had the processor.
std::chrono::nanoseconds waited_for_a_processor(const ChildProcess& program) {
    std::ifstream file("/proc/" + std::to_string(program.pid()) + "/schedstat");
    std::int64_t ran = 0, waited = 0;
    file >> ran >> waited;
    return std::chrono::nanoseconds(waited);
}

class WorstOfEachKind : public RunningBus {
  protected:
    WorstOfEachKind() {
        add({"operator", "eve"});
        // The broker that runs is told of it by its pid file.
        if (!wait_until([this] { return may_publish("eve", "asip/nobody/in"); }))
            throw std::runtime_error("eve");
    }

    struct Attack {
        std::string user;
        std::function<void(BusProbe&)> once;
        int times;
    };
    void flood(const std::string& user, const std::function<void(BusProbe&)>& once, int times) {
        flood({{user, once, times}});
    }
    /// Sends each attack, in a thread of its own, again and again, for as long as it takes to answer kStops
    /// stops of an operator. On a machine that does other things, too, the time does not count for which
    /// broker and agent had to wait for a processor.
    void flood(const std::vector<Attack>& attacks) {
        std::atomic<int> answered_meanwhile{0}, under_way{0}, begun{0};
        std::vector<std::thread> attackers;
        for (const auto& attack : attacks)
            attackers.emplace_back([&] {
                ++under_way;
                auto probe = this->probe(attack.user, {});
                for (int i = 0; i < attack.times || answered_meanwhile < kStops; ++i) {
                    if (HasFailure()) break;
                    // A broker that has enough of an attacker throws it out: it comes again.
                    wait_until([&] { return probe.connected(); }, 20s);
                    attack.once(probe);
                    if (i == 0) ++begun;
                    // What waits in the attacker's own memory is sent to no client.
                    if (i % kAtOnce == kAtOnce - 1)
                        wait_until([&] { return probe.all_acknowledged() || !probe.connected(); }, 20s);
                }
                wait_until([&] { return probe.all_acknowledged() || !probe.connected(); }, 20s);
                --under_way;
            });
        const auto all = static_cast<int>(attacks.size());
        EXPECT_TRUE(wait_until([&] { return begun == all; }));
        auto ann = probe("ann", {"asip/reply/ann/uno/stop"});
        int stops = 0;
        do {
            const auto begin = std::chrono::steady_clock::now();
            const auto waited = waited_for_a_processor(*broker_) + waited_for_a_processor(*agent_);
            mqtt::Message stop;
            stop.topic = "asip/uno/$stop";
            stop.response_topic = "asip/reply/ann/uno/stop";
            stop.correlation = "stop-" + std::to_string(++stops);
            stop.qos = 1;
            ann.publish(stop);
            const auto answered = ann.wait_for(
                [&](const mqtt::Message& message) { return message.correlation == stop.correlation; });
            const auto others = waited_for_a_processor(*broker_) + waited_for_a_processor(*agent_) - waited;
            const auto took = std::chrono::steady_clock::now() - begin - others;
            EXPECT_TRUE(answered) << "stop " << stops << " was never answered; " << agent_->errors();
            EXPECT_LT(took, 1s) << "stop " << stops;
            longest_ = std::max(longest_, took);
            if (under_way == all) ++answered_meanwhile;
        } while (under_way > 0 && !HasFailure());
        for (auto& attacker : attackers)
            attacker.join();
        EXPECT_GE(answered_meanwhile, kStops) << "stops while each attack was under way";
        stops_ += stops;
    }
    void expect_all_alive() {
        for (const auto& [program, unit] : {std::pair{agent_.get(), "asip-agent@.service"},
                                            {registry_.get(), "asip-registry.service"},
                                            {gateway_.get(), "asip-gateway.service"}}) {
            EXPECT_TRUE(program->running()) << unit << program->errors();
            EXPECT_LT(peak_bytes(*program), memory_limit(memory_max_of(unit))) << unit;
            RecordProperty(std::string(unit) + ".peak_bytes", std::to_string(peak_bytes(*program)));
        }
        RecordProperty("stops", stops_);
        RecordProperty(
            "longest_stop_ms",
            static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(longest_).count()));
        // Behind commands of the flood that still wait, in turn.
        EXPECT_TRUE(wait_until([&] { return agent_answers(); })) << agent_->errors();
        // A board whose credential is used for the flood may be online, too.
        EXPECT_EQ(asipctl("bob", {"list", "--board", "uno", "--state", "online", "-o", "name"}).output,
                  "uno\n")
            << registry_->errors();
        EXPECT_TRUE(wait_until([&] { return gateway_commands(); })) << gateway_->errors();
    }
    static mqtt::Message message(const std::string& topic, std::string payload = {}) {
        mqtt::Message made;
        made.topic = topic;
        made.payload = std::move(payload);
        made.qos = 1;
        return made;
    }

    static constexpr int kStops = 20, kAtOnce = 50;
    std::chrono::steady_clock::duration longest_{};
    int stops_ = 0;
};

TEST_F(WorstOfEachKind, CommandsThatAreMostlyProperties) {
    auto command = message("asip/uno/in", R"({"raw":"I,d,13,1"})");
    for (int i = 0; i < 15; ++i)
        command.user_properties.emplace_back("junk", std::string(65000, 'x'));
    flood("eve", [&](BusProbe& probe) { probe.publish(command); }, 150);
    expect_all_alive();
}

TEST_F(WorstOfEachKind, CommandsWithLongTopicsForAnswersAndLongCorrelations) {
    auto command = message("asip/uno/io/in", R"({"write":[13,1]})");
    command.response_topic = "asip/reply/eve/uno/" + std::string(60000, 'x');
    command.correlation = std::string(60000, 'y');
    flood("eve", [&](BusProbe& probe) { probe.publish(command); }, 800);
    expect_all_alive();
}

TEST_F(WorstOfEachKind, LargestCommandsAndDeepestJson) {
    const auto plain = message("asip/uno/in", std::string(kLargest, 'x'));
    const auto deep = message("asip/uno/io/in", std::string(kLargest, '['));
    const auto text = message("asip/uno/io/in", "{\"raw\":\"" + std::string(kLargest, '\\') + "\"}");
    flood(
        "eve",
        [&](BusProbe& probe) {
            for (const auto& each : {plain, deep, text})
                probe.publish(each);
        },
        40);
    expect_all_alive();
}

TEST_F(WorstOfEachKind, CommandsOfTenThousandClients) {
    int client = 0;
    flood(
        "eve",
        [&](BusProbe& probe) {
            auto command = message("asip/uno/in", "I,d,13,1");
            command.response_topic = "asip/reply/eve/uno/c" + std::to_string(++client);
            command.correlation = std::string(256, 'x');
            probe.publish(command);
        },
        10'000);
    expect_all_alive();
}

TEST_F(WorstOfEachKind, DemandsOfThousandsOfClients) {
    int client = 0;
    flood(
        "bob",
        [&](BusProbe& probe) {
            probe.publish(message("asip/servicebus/uno/$demand/bob/c" + std::to_string(++client),
                                  R"({"services":{"io":{"hz":100}},"lease":300})"));
            probe.publish(message("asip/servicebus/uno/$demand/bob/x", std::string(100'000, '{')));
        },
        2'000);
    expect_all_alive();
}

TEST_F(WorstOfEachKind, ProbesAndQuestionsOfAViewer) {
    int question = 0;
    flood(
        "bob",
        [&](BusProbe& probe) {
            probe.publish(message("asip/servicebus/$probe", std::string(1000, 'x')));
            auto query = message("asip/registry/query", R"({"find":"services"})");
            query.response_topic = "asip/reply/bob/registry/c" + std::to_string(++question);
            query.correlation = std::string(256, 'x');
            probe.publish(query);
            query.payload = std::string(200'000, '[');
            probe.publish(query);
        },
        1'000);
    expect_all_alive();
}

/// To the registry and the gateway, by the credential of a board.
TEST_F(WorstOfEachKind, DescriptionsAndNamesOfABoard) {
    int number = 0;
    flood(
        "uno2",
        [&](BusProbe& probe) {
            const auto tag = std::to_string(++number);
            auto description =
                message("asip/servicebus/uno2/$description",
                        R"({"board":"uno2","session":"s)" + tag + R"(","seq":1,"lease":60,"x":")" +
                            std::string(60'000, 'x') + R"(","services":[]})");
            description.retain = true;
            probe.publish(description);
            probe.publish(message("asip/servicebus/uno2/$description", std::string(kLargest / 4, '{')));
            probe.publish(message("asip/servicebus/uno2", "service-" + tag));
            probe.publish(message("asip/servicebus/uno2/$state", number % 2 == 0 ? "online" : "lost"));
            probe.publish(message("asip/servicebus/uno2/$commands", std::string(60'000, 'x')));
            probe.publish(message("asip/servicebus/uno2/$stats", std::string(200'000, 'x')));
        },
        300);
    expect_all_alive();
}

TEST_F(WorstOfEachKind, ValuesOfHundredsOfServicesOfABoard) {
    int number = 0;
    flood(
        "uno2",
        [&](BusProbe& probe) {
            probe.publish(
                message("asip/uno2/s" + std::to_string(++number) + "/out", std::string(kLargest, 'x')));
            probe.publish(
                message("asip/uno2/s" + std::to_string(number) + "/error", std::string(100'000, 'x')));
        },
        300);
    expect_all_alive();
}

/// An operator, a viewer and a board, each with its worst.
TEST_F(WorstOfEachKind, AllOfThemAtOnce) {
    int client = 0, question = 0, service = 0;
    flood({{"eve",
            [&](BusProbe& probe) {
                auto command = message("asip/uno/in", "I,d,13,1");
                command.response_topic = "asip/reply/eve/uno/c" + std::to_string(++client);
                command.correlation = std::string(256, 'x');
                probe.publish(command);
                probe.publish(message("asip/uno/io/in", std::string(kLargest / 8, '[')));
            },
            200},
           {"bob",
            [&](BusProbe& probe) {
                auto query = message("asip/registry/query", R"({"find":"services"})");
                query.response_topic = "asip/reply/bob/registry/c" + std::to_string(++question);
                probe.publish(query);
                probe.publish(message("asip/servicebus/$probe", std::string(1000, 'x')));
                probe.publish(message("asip/servicebus/uno/$demand/bob/c" + std::to_string(question),
                                      R"({"services":{"io":{"hz":100}},"lease":300})"));
            },
            500},
           {"uno2",
            [&](BusProbe& probe) {
                probe.publish(message("asip/uno2/s" + std::to_string(++service % 300) + "/out",
                                      std::string(kLargest / 4, 'x')));
                probe.publish(message("asip/servicebus/uno2/$state", service % 2 == 0 ? "online" : "lost"));
            },
            200}});
    expect_all_alive();
}

}  // namespace
}  // namespace asip::test
