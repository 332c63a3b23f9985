// SPDX-License-Identifier: Apache-2.0
// A stop that holds: real broker, agent, registry, asipctl and firmware; the simulator says when the motor
// runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class StopThatHolds : public testing::Test {
  protected:
    StopThatHolds() { start_agent(); }
    void start_agent() {
        probe.clear();
        agent = std::make_unique<ChildProcess>(std::vector<std::string>{
            ASIP_PROGRAMS "/asip-agent", "--serial", robot.port(), "--broker", broker.url(), "--name",
            "robot", "--takeover", "--no-step-up", "--keep-outputs", "--state-dir", state.path().string()});
        if (!wait_state(probe, "online", kDeadline, "robot")) throw std::runtime_error(agent->errors());
    }
    json ask(const std::string& topic, const std::string& payload) {
        const auto reply = probe.request(topic, payload);
        return reply ? json::parse(*reply) : json();
    }
    json drive() { return ask("asip/robot/motors/in", R"({"power":[0,200]})"); }
    int asipctl(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), ASIP_PROGRAMS "/asipctl");
        ChildProcess program(std::move(arguments), {{"ASIP_BROKER", broker.address()}});
        const auto status = program.wait_exit();
        said = program.output() + program.errors();
        return status.value_or(-1);
    }

    TempDir state;
    MosquittoBroker broker;
    SimulatedRobot robot;
    BusProbe probe{broker.port()};
    std::unique_ptr<ChildProcess> agent;
    std::string said;
};

TEST_F(StopThatHolds, Asipctl_StopsRefusesShowsAndResumes) {
    ASSERT_EQ(drive()["status"], "ok");
    ASSERT_TRUE(wait_until([&] { return robot.runs(); }));
    EXPECT_EQ(asipctl({"stop", "robot", "--why", "dog on the track"}), 0) << said;
    EXPECT_THAT(said, HasSubstr("stopped until resumed"));
    EXPECT_TRUE(wait_until([&] { return !robot.runs(); }));
    const auto refused = drive();
    EXPECT_EQ(refused["reason"], "stopped");
    EXPECT_THAT(refused["error"].get<std::string>(), HasSubstr("dog on the track"));
    EXPECT_EQ(asipctl({"send", "robot/motors", "power", "0", "100"}), 1);
    EXPECT_THAT(said, HasSubstr("asipctl resume robot"));
    asipctl({"list", "--from-bus"});
    EXPECT_THAT(said, HasSubstr("STOPPED until it is resumed"));
    asipctl({"show", "robot"});
    EXPECT_THAT(said, AllOf(HasSubstr("STOPPED until it is resumed"), HasSubstr("dog on the track")));
    EXPECT_EQ(asipctl({"resume", "robot"}), 0) << said;
    EXPECT_EQ(drive()["status"], "ok");
    EXPECT_TRUE(wait_until([&] { return robot.runs(); }));
}

TEST_F(StopThatHolds, AgentKilledAndBrokerWithoutMemory_ItHolds) {
    ASSERT_EQ(asipctl({"stop", "robot"}), 0) << said;
    const auto kept = state.path() / "stopped" / "robot.json";
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(kept); }));
    agent->signal(SIGKILL);
    ASSERT_TRUE(agent->wait_exit());
    broker.restart();
    start_agent();
    EXPECT_EQ(drive()["reason"], "stopped");
    EXPECT_FALSE(robot.runs());
    EXPECT_EQ(asipctl({"resume", "--all"}), 0) << said;
    EXPECT_TRUE(wait_until([&] { return !std::filesystem::exists(kept); }));
    EXPECT_EQ(drive()["status"], "ok");
}

}  // namespace
}  // namespace asip::test
