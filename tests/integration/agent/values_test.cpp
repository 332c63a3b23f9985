// SPDX-License-Identifier: Apache-2.0
// How a board stands is known on the bus: real broker, agent, registry, asipctl and firmware.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::ContainerEq;

constexpr const char* kValuesTopic = "asip/uno1/$values";
constexpr const char* kList = "asip/servicebus/uno1/$properties";

class Values : public testing::Test {
  protected:
    Values() { start_agent(); }
    void start_agent() {
        agent = std::make_unique<Agent>(broker, uno.port(), std::vector<std::string>{"--lease", "3"});
        if (!wait_state(probe, "online")) throw std::runtime_error(agent->process().errors());
    }
    json ask(const std::string& payload) {
        const auto reply = probe.request("asip/uno1/io/in", payload);
        return reply ? json::parse(*reply) : json();
    }
    static json known_in(const std::string& payload) {
        json result = json::object();
        const auto document = json::parse(payload, nullptr, false);
        if (!document.is_object()) return result;
        for (const auto& [id, shown] : document.at("values").items())
            if (id.starts_with("io/") && shown.contains("value")) result[id] = shown.at("value");
        return result;
    }
    /// Until the newest message says that these are known of the pins.
    bool says(const json& expected) {
        return wait_until([&] {
            const auto last = probe.last(kValuesTopic);
            return last && known_in(*last) == expected;
        });
    }
    /// What a client finds on `topic` that comes now; "" for nothing.
    std::string stored(const std::string& topic = kValuesTopic) {
        BusProbe late(broker.port(), {topic});
        const auto found = late.wait_for(topic, 1s);
        return found && found->retain ? found->payload : "";
    }
    json shown() {
        ChildProcess program(
            {ASIP_PROGRAMS "/asipctl", "show", "uno1/io", "-o", "json", "--broker", broker.address()});
        EXPECT_TRUE(program.wait_exit()) << program.errors();
        return json::parse(program.output(), nullptr, false).value("values", json::object());
    }

    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe{broker.port(), {"asip/#"}};
    std::unique_ptr<Agent> agent;
    const json on{{"io/13", true}};
};

TEST_F(Values, TwoSenders_LateJoinerAndViewsKnowBoth) {
    BusProbe other(broker.port(), {});
    ASSERT_EQ(ask(R"({"mode":[13,"output"]})")["status"], "ok");
    ASSERT_EQ(ask(R"({"write":[13,1]})")["status"], "ok");
    other.publish("asip/uno1/in", "I,P,3,5");
    other.publish("asip/uno1/in", "I,a,3,255");
    const json all{{"io/13", true}, {"io/3", 255}};
    EXPECT_TRUE(says(all)) << *probe.last(kValuesTopic);
    EXPECT_EQ(known_in(stored()), all);
    EXPECT_EQ(shown(), all);
}

TEST_F(Values, AgentKilled_TheNextOneSaysWhatItDoesNotKnow) {
    ASSERT_EQ(ask(R"({"mode":[13,"output"]})")["status"], "ok");
    ASSERT_EQ(ask(R"({"write":[13,1]})")["status"], "ok");
    ASSERT_TRUE(says(on));
    agent->kill();
    EXPECT_EQ(known_in(stored()), on);
    ASSERT_TRUE(wait_state(probe, "lost"));
    probe.clear();
    start_agent();
    EXPECT_TRUE(says(json::object())) << agent->process().errors();
    EXPECT_THAT(shown(), ContainerEq(json::object()));
}

TEST_F(Values, BoardForgotten_NothingIsLeft) {
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--broker", broker.address(), "--id", "r1"});
    ASSERT_TRUE(registry.wait_for_errors("catalogue is complete")) << registry.errors();
    ASSERT_EQ(ask(R"({"mode":[13,"output"]})")["status"], "ok");
    ASSERT_EQ(ask(R"({"write":[13,1]})")["status"], "ok");
    ASSERT_TRUE(says(on));
    agent->kill();
    ASSERT_TRUE(wait_state(probe, "lost"));
    probe.publish("asip/uno1/io/set", R"({"write":{"13":1}})", true);
    const auto forgotten = [&] {
        const auto answer = probe.request("asip/registry/query", R"({"forget":"uno1"})");
        return answer && json::parse(*answer).value("refused", "").empty();
    };
    ASSERT_TRUE(wait_until(forgotten));
    for (const std::string topic : {kValuesTopic, kList, "asip/uno1/io/set"})
        EXPECT_TRUE(wait_until([&] { return stored(topic).empty(); })) << topic;
}

}  // namespace
}  // namespace asip::test
