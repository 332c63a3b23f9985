// SPDX-License-Identifier: Apache-2.0
// What was set is known on the bus: real broker, agent, registry, asipctl and firmware.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kSet = "asip/uno1/io/set";

class WhatWasSet : public testing::Test {
  protected:
    WhatWasSet() { start_agent(); }
    void start_agent() {
        agent = std::make_unique<Agent>(broker, uno.port(), std::vector<std::string>{"--lease", "3"});
        if (!wait_state(probe, "online")) throw std::runtime_error(agent->process().errors());
    }
    json ask(const std::string& payload) {
        const auto reply = probe.request("asip/uno1/io/in", payload);
        return reply ? json::parse(*reply) : json();
    }
    /// Until the newest message says it; "" where it is cleared.
    bool says(const std::string& expected) {
        return wait_until([&] { return probe.last(kSet) == expected; });
    }
    /// What a client finds that comes now; "" for nothing.
    std::string stored() {
        BusProbe late(broker.port(), {"asip/uno1/+/set"});
        probe.publish("asip/mark", "", false);
        const auto found = late.wait_for(kSet, 1s);
        return found && found->retain ? found->payload : "";
    }
    json shown() {
        ChildProcess program(
            {ASIP_PROGRAMS "/asipctl", "show", "uno1/io", "-o", "json", "--broker", broker.address()});
        EXPECT_TRUE(program.wait_exit()) << program.errors();
        return json::parse(program.output(), nullptr, false).value("set", json());
    }

    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe{broker.port(), {"asip/#"}};
    std::unique_ptr<Agent> agent;
};

TEST_F(WhatWasSet, TwoSenders_LateJoinerAndViewsKnowBoth) {
    BusProbe other(broker.port(), {});
    ASSERT_EQ(ask(R"({"mode":[13,"output"]})")["status"], "ok");
    ASSERT_EQ(ask(R"({"write":[13,1]})")["status"], "ok");
    other.publish("asip/uno1/in", "I,P,3,5");
    other.publish("asip/uno1/in", "I,a,3,77");
    const std::string all = R"({"mode":{"13":3,"3":5},"pwm":{"3":77},"write":{"13":1}})";
    EXPECT_TRUE(says(all)) << *probe.last(kSet);
    EXPECT_EQ(stored(), all);
    EXPECT_EQ(shown(), json::parse(all));
}

TEST_F(WhatWasSet, RefusedOrNotExecuted_IsUnchanged) {
    ASSERT_EQ(ask(R"({"mode":[13,"output"]})")["status"], "ok");
    ASSERT_TRUE(says(R"({"mode":{"13":3}})"));
    EXPECT_EQ(ask(R"({"write":[0,1]})")["status"], "error") << "the pin of the line to the agent";
    EXPECT_EQ(ask(R"({"write":[13,2]})")["status"], "refused");
    ASSERT_EQ(ask(R"({"write":[13,1]})")["status"], "ok");
    EXPECT_TRUE(says(R"({"mode":{"13":3},"write":{"13":1}})")) << *probe.last(kSet);
}

TEST_F(WhatWasSet, BoardRestarts_IsCleared) {
    ASSERT_EQ(ask(R"({"mode":[13,"output"]})")["status"], "ok");
    ASSERT_TRUE(says(R"({"mode":{"13":3}})"));
    uno.command("reset");
    EXPECT_TRUE(says(""));
    EXPECT_EQ(stored(), "");
    ASSERT_TRUE(wait_until([&] { return ask(R"({"write":[13,1]})")["status"] == "ok"; })) << "works again";
    EXPECT_TRUE(says(R"({"write":{"13":1}})"));
}

TEST_F(WhatWasSet, AgentKilled_TheNextOneClearsWhatItDoesNotKnow) {
    ASSERT_EQ(ask(R"({"mode":[13,"output"]})")["status"], "ok");
    ASSERT_TRUE(says(R"({"mode":{"13":3}})"));
    agent->kill();
    EXPECT_EQ(stored(), R"({"mode":{"13":3}})");
    ASSERT_TRUE(wait_state(probe, "lost"));
    probe.clear();
    start_agent();
    EXPECT_TRUE(says("")) << agent->process().errors();
    EXPECT_EQ(stored(), "");
    EXPECT_TRUE(shown().is_null());
}

TEST_F(WhatWasSet, AgentStopped_IsCleared) {
    ASSERT_EQ(ask(R"({"mode":[13,"output"]})")["status"], "ok");
    ASSERT_TRUE(says(R"({"mode":{"13":3}})"));
    agent->process().signal(SIGTERM);
    EXPECT_TRUE(says(""));
    EXPECT_EQ(agent->process().wait_exit(), 0);
}

TEST_F(WhatWasSet, BrokerRestartsWithoutMemory_IsThereAgain) {
    ASSERT_EQ(ask(R"({"mode":[13,"output"]})")["status"], "ok");
    ASSERT_TRUE(says(R"({"mode":{"13":3}})"));
    broker.restart();
    probe.clear();
    EXPECT_TRUE(says(R"({"mode":{"13":3}})"));
    EXPECT_EQ(stored(), R"({"mode":{"13":3}})");
}

TEST_F(WhatWasSet, BoardForgotten_NothingIsLeft) {
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--broker", broker.address(), "--id", "r1"});
    ASSERT_TRUE(registry.wait_for_errors("catalogue is complete")) << registry.errors();
    ASSERT_EQ(ask(R"({"mode":[13,"output"]})")["status"], "ok");
    ASSERT_TRUE(says(R"({"mode":{"13":3}})"));
    agent->kill();
    ASSERT_TRUE(wait_state(probe, "lost"));
    const auto forgotten = [&] {
        const auto answer = probe.request("asip/registry/query", R"({"forget":"uno1"})");
        return answer && json::parse(*answer).value("refused", "").empty();
    };
    ASSERT_TRUE(wait_until(forgotten));
    EXPECT_TRUE(says(""));
    EXPECT_EQ(stored(), "");
}

}  // namespace
}  // namespace asip::test
