// SPDX-License-Identifier: Apache-2.0
// Commands that were delayed on their way to the agent. Real broker, agent and firmware; the simulator says
// whether the motor's pin changed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "tests/integration/agent/rig.hpp"
#include "tests/support/tcp_relay.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kMotors = "asip/robot/motors/in";
constexpr const char* kForward = R"({"power":[0,200],"reply_to":"answers","id":)";
// More than the usual deadline, and less than the broker's silence that ends the connection.
constexpr auto kDelayed = 6s;
constexpr auto kSometimes = 1500ms;

class LateCommand : public testing::Test {
  protected:
    LateCommand() {
        agent = std::make_unique<ChildProcess>(std::vector<std::string>{
            ASIP_PROGRAMS "/asip-agent", "--serial", robot.port(), "--broker",
            "mqtt://127.0.0.1:" + std::to_string(relay.port()), "--name", "robot", "--log-level", "debug"});
    }
    /// The board is there, and was commanded a moment ago.
    bool commanded() {
        if (!wait_state(probe, "online", kDeadline, "robot") || !is_ok(R"({"power":[0,0]})")) return false;
        std::this_thread::sleep_for(kSometimes);
        return true;
    }
    bool is_ok(const std::string& command) {
        const auto answer = probe.request(kMotors, command, time_limit(2s));
        return answer && json::parse(*answer)["status"] == "ok";
    }
    void send(int count, const std::string& more = "") {
        for (int i = 0; i < count; ++i)
            probe.publish(kMotors, kForward + std::to_string(i) + more + "}");
    }
    void expect_refused(std::size_t count) {
        ASSERT_TRUE(wait_until([&] { return probe.count("answers") >= count; })) << agent->errors();
        for (const auto& answer : probe.messages("answers")) {
            EXPECT_EQ(json::parse(answer.payload)["status"], "refused") << answer.payload;
            EXPECT_EQ(json::parse(answer.payload)["reason"], "deadline") << answer.payload;
        }
        EXPECT_THAT(robot.switched(), testing::IsEmpty()) << "the motor ran";
    }
    void expect_usable_soon() {
        EXPECT_TRUE(wait_until([&] { return is_ok(R"({"power":[0,200]})"); }, time_limit(2s)))
            << agent->errors();
        EXPECT_TRUE(wait_until([&] { return robot.runs(); }));
        EXPECT_THAT(agent->errors(), Not(HasSubstr("broker lost")));
    }

    MosquittoBroker broker;
    TcpRelay relay{broker.port()};
    SimulatedRobot robot;
    BusProbe probe{broker.port()};
    std::unique_ptr<ChildProcess> agent;
};

TEST_F(LateCommand, BrokerStoodStill_IsRefused) {
    ASSERT_TRUE(commanded()) << agent->errors();
    broker.freeze();
    send(1);
    std::this_thread::sleep_for(kDelayed);
    broker.thaw();
    expect_refused(1);
    expect_usable_soon();
}

TEST_F(LateCommand, MoreThanTheBrokerSendsAtOnce_AllAreRefused) {
    ASSERT_TRUE(commanded()) << agent->errors();
    relay.cut();
    send(60);
    std::this_thread::sleep_for(kDelayed);
    relay.restore();
    expect_refused(60);
    expect_usable_soon();
}

/// The agent's broker, and another one with a bridge to it that speaks MQTT 3.1.1: nothing expires on it.
class DelayedBetweenBrokers : public testing::Test {
  protected:
    /// A command of a client at the other broker, as an MQTT 3.1.1 client sends it.
    void send(const std::string& id, const std::string& clock, int power) {
        probe.publish(
            kMotors,
            json{{"power", {0, power}}, {"reply_to", "answers"}, {"id", id}, {"clock", clock}}.dump());
    }
    json answer_to(const std::string& id) {
        json found;
        EXPECT_TRUE(wait_until([&] {
            for (const auto& message : probe.messages("answers"))
                if (auto answer = json::parse(message.payload); answer["id"] == id) found = std::move(answer);
            return !found.is_null();
        })) << agent.errors();
        return found;
    }

    MosquittoBroker broker;
    TcpRelay relay{broker.port()};
    MosquittoBroker other{
        {.extra_lines = {"connection hub", "address 127.0.0.1:" + std::to_string(relay.port()),
                         "topic # both 1", "bridge_protocol_version mqttv311", "notifications false",
                         "restart_timeout 1 2"}}};
    SimulatedRobot robot;
    ChildProcess agent{
        {ASIP_PROGRAMS "/asip-agent", "--serial", robot.port(), "--broker", broker.url(), "--name", "robot"}};
    BusProbe probe{other.port()};
};

TEST_F(DelayedBetweenBrokers, CommandThatTellsWhenItWasSent_IsRefused) {
    ASSERT_TRUE(wait_state(probe, "online", kDeadline, "robot")) << agent.errors();
    send("first", "", 0);
    const auto first = answer_to("first");
    ASSERT_EQ(first["status"], "ok");
    relay.cut();
    send("late", first["clock"], 200);
    std::this_thread::sleep_for(kDelayed);
    relay.restore();
    const auto late = answer_to("late");
    EXPECT_EQ(late["status"], "refused");
    EXPECT_EQ(late["reason"], "deadline");
    EXPECT_THAT(robot.switched(), testing::IsEmpty()) << "the motor ran";
    send("then", late["clock"], 200);
    EXPECT_EQ(answer_to("then")["status"], "ok");
    EXPECT_TRUE(wait_until([&] { return robot.runs(); }));
}

}  // namespace
}  // namespace asip::test
