// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "asip/model/description.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

std::optional<model::Description> description(const BusProbe& probe) {
    const auto text = probe.last("asip/servicebus/uno1/$description");
    if (!text) return std::nullopt;
    const auto parsed = model::parse_description(*text);
    if (!parsed) return std::nullopt;
    return *parsed;
}

TEST(AgentAnnounces, RealBoard_InBothLayersWithPinsAndModels) {
    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe(broker.port());
    Agent agent(broker, uno.port());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    ASSERT_TRUE(probe.wait_for("asip/servicebus", "uno1"));
    for (const char* service : {"io", "distance", "servo"})
        EXPECT_TRUE(probe.wait_for("asip/servicebus/uno1", service));
    const auto known = description(probe);
    ASSERT_TRUE(known);
    EXPECT_EQ(known->firmware.chip, "ATmega328P");
    EXPECT_EQ(known->pins.capabilities.size(), 20u);
    ASSERT_NE(known->service("distance"), nullptr);
    EXPECT_EQ(known->service("distance")->model, "distance@1");
    EXPECT_GT(known->link.baud, 57600);
    EXPECT_LE(probe.last("asip/servicebus/uno1/$description")->size(), 1024u);

    BusProbe late(broker.port());
    EXPECT_TRUE(late.wait_for("asip/servicebus/uno1/$state", "online"));
    EXPECT_TRUE(late.wait_for("asip/servicebus/uno1/$description"));
    late.clear();
    late.publish("asip/servicebus/$probe", "");
    EXPECT_TRUE(late.wait_for("asip/servicebus", "uno1", time_limit(2s)))
        << "a probe is answered within a second";
}

TEST(AgentAnnounces, Plain04Board_WithItsServices) {
    MosquittoBroker broker;
    SimulatedUno uno("asip_uno_04_services");
    BusProbe probe(broker.port());
    Agent agent(broker, uno.port());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    ASSERT_TRUE(wait_until([&] { return description(probe).has_value(); }));
    EXPECT_TRUE(description(probe)->firmware.extensions.empty());
    EXPECT_EQ(description(probe)->link.baud, 57600);
    const auto reply = probe.request("asip/uno1/io/in", R"({"write":[13,1]})");
    ASSERT_TRUE(reply);
    EXPECT_THAT(*reply, HasSubstr(R"("proof":"fence")"));
}

TEST(AgentAnnounces, Sigterm_SaysOfflineAndEndsWithinASecond) {
    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe(broker.port());
    Agent agent(broker, uno.port());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    agent.process().signal(SIGTERM);
    EXPECT_EQ(agent.process().wait_exit(time_limit(1s)), 0);
    EXPECT_TRUE(wait_state(probe, "offline", time_limit(1s)));
}

TEST(AgentAnnounces, SighupOfOneBoard_IsAnsweredInWordsAndTheBoardStays) {
    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe(broker.port());
    Agent agent(broker, uno.port());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    agent.process().signal(SIGHUP);
    EXPECT_TRUE(agent.process().wait_for_errors("SIGHUP: there is no file .* to read again; going on"));
    const auto reply = probe.request("asip/uno1/io/in", R"({"write":[13,1]})");
    ASSERT_TRUE(reply);
    EXPECT_THAT(*reply, HasSubstr(R"("status":"ok")"));
    EXPECT_TRUE(agent.process().running());
}

TEST(AgentAnnounces, TerminalClosed_AgentSaysGoodbyeUnlessStartedByNohup) {
    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe(broker.port());
    // Closes the terminal at the first line of its input; at the second ends as the agent does, by SIGTERM
    // where it is "end".
    const std::string in_terminal = R"(import os, pty, sys
pid, terminal = pty.fork()
if pid == 0: os.execvp('sh', ['sh', '-c', 'exec "$@" >/dev/null 2>&1', 'sh', *sys.argv[1:]])
sys.stdin.readline()
os.close(terminal)
if sys.stdin.readline() == 'end\n': os.kill(pid, 15)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])))";
    const auto start = [&](bool nohup) {
        auto words = agent_command(broker.url(), uno.port());
        if (nohup) words.insert(words.begin(), "nohup");
        words.insert(words.begin(), {"/usr/bin/python3", "-c", in_terminal});
        return std::make_unique<ChildProcess>(words);
    };
    auto process = start(false);
    ASSERT_TRUE(wait_state(probe, "online")) << process->errors();
    process->write_input("close\n");
    EXPECT_TRUE(wait_state(probe, "offline")) << "it went on without its terminal";
    process->write_input("wait\n");
    EXPECT_EQ(process->wait_exit(), 0) << process->errors();

    process = start(true);
    ASSERT_TRUE(wait_state(probe, "online")) << process->errors();
    process->write_input("close\n");
    const auto reply = probe.request("asip/uno1/io/in", R"({"write":[13,1]})");
    ASSERT_TRUE(reply);
    EXPECT_THAT(*reply, HasSubstr(R"("status":"ok")"));
    process->write_input("end\n");
    EXPECT_EQ(process->wait_exit(), 0) << process->errors();
}

class BrokerReturns : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Broker, BrokerReturns, testing::Bool(), [](const auto& param) {
    return param.param ? "WithPersistence" : "WithoutPersistence";
});

TEST_P(BrokerReturns, KilledAndRestarted_AnnouncedWithinThreeSeconds) {
    MosquittoBroker broker({.persistence = GetParam()});
    SimulatedUno uno;
    Agent agent(broker, uno.port());
    {
        BusProbe probe(broker.port());
        ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    }
    broker.kill();
    broker.start();
    BusProbe probe(broker.port());
    EXPECT_TRUE(probe.wait_for(
        [](const mqtt::Message& m) { return !m.retain && m.topic == "asip/servicebus/uno1/$description"; },
        time_limit(3s)))
        << agent.process().errors();
    EXPECT_TRUE(wait_state(probe, "online", time_limit(1s)));
    EXPECT_TRUE(agent.process().running());
}

TEST(AgentAnnounces, NameHeldByALivingAgent_SecondOneEndsAndSaysWho) {
    MosquittoBroker broker;
    SimulatedUno uno, other;
    BusProbe probe(broker.port());
    Agent agent(broker, uno.port());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    Agent second(broker, other.port());
    EXPECT_EQ(second.process().wait_exit(), 6);
    EXPECT_THAT(second.process().errors(), HasSubstr("--takeover"));
    EXPECT_TRUE(agent.process().running());
    EXPECT_EQ(probe.last("asip/servicebus/uno1/$state"), "online");
}

}  // namespace
}  // namespace asip::test
