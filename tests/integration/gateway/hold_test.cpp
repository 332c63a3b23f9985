// SPDX-License-Identifier: Apache-2.0
// A motor runs on a command that a browser holds, and the browser, its network or the gateway dies. Real
// broker, agent and firmware; the simulator says when the motor's pin really changed.
#include <gmock/gmock.h>

#include <csignal>

#include "running_gateway.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using std::chrono::milliseconds;

// A client of a busy machine may renew a second late.
constexpr milliseconds kHeld = 1500ms;
constexpr milliseconds kOnTop = 100ms;  // what the bus promises
constexpr milliseconds kRenewal = 250ms;
constexpr int kRenewals = 10;

class GatewayHold : public testing::Test {
  protected:
    void SetUp() override { ASSERT_TRUE(gateway_.becomes("robot", "online")) << gateway_.process().errors(); }

    /// Longer than it runs without renewals.
    void renew_for_a_while(const std::function<void()>& renew) {
        for (int i = 0; i < kRenewals; ++i) {
            std::this_thread::sleep_for(kRenewal);
            renew();
        }
        EXPECT_EQ(robot_.switched().size(), 1u) << "it runs, without a break";
    }
    void expect_stop(const char* after) {
        const auto began = std::chrono::steady_clock::now();
        ASSERT_TRUE(wait_until([&] { return !robot_.runs(); }, 10s)) << "the motor runs on after " << after;
        const auto took = std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - began);
        std::cout << "    stopped " << took.count() << " ms after " << after << '\n';
        EXPECT_LE(took, kHeld + time_limit(kOnTop)) << after;
    }
    /// A WebSocket that has the motor run and has renewed it.
    std::unique_ptr<Socket> holding_socket() {
        auto socket = std::make_unique<Socket>(gateway_.port());
        // A board of a busy machine may answer too late once.
        for (int attempt = 0; attempt < 5 && !robot_.runs(); ++attempt) {
            socket->send(R"({"command":"robot/motors","power":[0,200],"id":"7","hold_ms":1500})");
            const auto answer = socket->json();
            EXPECT_EQ(answer["id"], "7") << answer;
        }
        EXPECT_TRUE(wait_until([&] { return robot_.runs(); }));
        renew_for_a_while([&] { socket->send(R"({"command":"robot/motors","renew":true,"id":"7"})"); });
        return socket;
    }

    MosquittoBroker broker_{{.extra_lines = {"max_queued_messages 0"}}};
    SimulatedRobot robot_;
    ChildProcess agent_{std::vector<std::string>{ASIP_PROGRAMS "/asip-agent", "--serial", robot_.port(),
                                                 "--broker", broker_.url(), "--name", "robot"}};
    RunningGateway gateway_{broker_.address()};
};

TEST_F(GatewayHold, PhoneAsleep_StopsInTime) {
    const auto socket = holding_socket();
    expect_stop("the last renewal; the connection stays");
}

TEST_F(GatewayHold, TabClosed_StopsInTime) {
    holding_socket().reset();
    expect_stop("the end of the connection");
}

TEST_F(GatewayHold, GatewayKilled_StopsInTime) {
    const auto socket = holding_socket();
    gateway_.process().signal(SIGKILL);
    expect_stop("kill -9 of the gateway");
}

TEST_F(GatewayHold, RenewedByPost_RunsOnAndStopsInTime) {
    std::string id;
    for (int attempt = 0; attempt < 5 && !robot_.runs(); ++attempt) {
        const auto held =
            post(gateway_.port(), "/api/boards/robot/services/motors/commands/power?hold_ms=1500", "[0,200]");
        id = held.json().value("id", "");
    }
    ASSERT_FALSE(id.empty());
    ASSERT_TRUE(wait_until([&] { return robot_.runs(); }));
    renew_for_a_while([&] {
        const auto renewed = post(gateway_.port(), "/api/commands/" + id + "/renew");
        EXPECT_EQ(renewed.status / 100, 2) << renewed.body;
    });
    expect_stop("the last renewal");
    const auto late = post(gateway_.port(), "/api/commands/" + id + "/renew");
    EXPECT_FALSE(robot_.runs()) << late.body << ": what has been undone does not come back";
}

}  // namespace
}  // namespace asip::test
