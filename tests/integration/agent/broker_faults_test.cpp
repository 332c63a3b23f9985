// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

#include "tests/integration/agent/fake_port.hpp"
#include "tests/integration/agent/rig.hpp"
#include "tests/support/counted.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

/// A file with this password.
std::string password(const std::string& text) {
    static const TempDir folder;
    return folder.write(text, text + "\n");
}

TEST(AgentBroker, RightPassword_IsOnline) {
    MosquittoBroker broker({.users = {{"pi", "right"}}});
    FakePort port;
    BusProbe probe(broker.port(), {"#"}, {.user = "pi", .password = "right"});
    Agent agent(broker, port.path(), {"--user", "pi", "--password-file", password("right")});
    EXPECT_TRUE(wait_state(probe, "online")) << agent.process().errors();
}

TEST(AgentBroker, AnnouncingDenied_IsWarnedOfWithWhatToDo) {
    TempDir folder;
    const auto rules = folder.write("acl", "user pi\ntopic read #\ntopic write asip/uno1/#\n");
    MosquittoBroker broker({.users = {{"pi", "right"}}, .extra_lines = {"acl_file " + rules}});
    FakePort port;
    Agent agent(broker, port.path(), {"--user", "pi", "--password-file", password("right")});
    ASSERT_TRUE(agent.process().wait_for_errors("access control denied announcing board uno1"))
        << agent.process().errors();
    EXPECT_THAT(agent.process().errors(), HasSubstr("asipctl secure add board uno1"));
    EXPECT_TRUE(agent.process().running());
}

TEST(AgentBroker, AnnouncementLargerThanTheBrokerTakes_IsWarnedOfWithItsLimit) {
    MosquittoBroker broker({.extra_lines = {"max_packet_size 300"}});
    FakePort port;
    Agent agent(broker, port.path());
    const auto line = agent.process().wait_for_errors("larger than the broker takes");
    ASSERT_TRUE(line) << agent.process().errors();
    EXPECT_THAT(*line, HasSubstr("=300"));
    EXPECT_THAT(*line, testing::ContainsRegex("a message of [0-9]{3,4} bytes"));
    EXPECT_THAT(agent.process().errors(), testing::Not(HasSubstr("access control")));
}

TEST(AgentBroker, ClientCertificateDemanded_IsOnlineWithItAndEndsWithout) {
    MosquittoBroker broker({.tls = true, .require_client_certificate = true});
    const auto& files = broker.certificates();
    FakePort port;
    {
        Agent agent(broker, port.path(),
                    {"--ca", files.ca, "--cert", files.client_cert, "--key", files.client_key});
        BusProbe probe(broker.port(), {"#"},
                       {.ca = files.ca, .cert = files.client_cert, .key = files.client_key});
        EXPECT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    }
    const auto ended = run(agent_command(broker.url(), port.path(), {"--ca", files.ca}));
    EXPECT_EQ(ended.status, 3) << ended.errors;
}

TEST(AgentBroker, NotThereYet_IsWaitedFor) {
    MosquittoBroker broker;
    broker.stop();
    FakePort port;
    Agent agent(broker, port.path());
    ASSERT_TRUE(agent.process().wait_for_errors("broker not reachable")) << agent.process().errors();
    broker.start();
    BusProbe probe(broker.port());
    EXPECT_TRUE(wait_state(probe, "online")) << agent.process().errors();
}

TEST(AgentBroker, HugePayloadOnAControlTopic_CostsTheAgentNothing) {
    MosquittoBroker broker;
    FakePort port;
    BusProbe probe(broker.port());
    Agent agent(broker, port.path());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    BusProbe sender(broker.port(), {});
    sender.publish("asip/uno1/io/in", std::string(std::size_t{120} << 20, 'x'), false, 1);
    ASSERT_TRUE(wait_until([&] { return sender.all_acknowledged(); }, 30s));
    sender.publish("asip/uno1/$nothing", "", false, 1);
    ASSERT_TRUE(wait_until([&] { return sender.all_acknowledged(); }));
    EXPECT_LT(agent.process().resident_bytes(), memory_limit(std::size_t{20} << 20));
    EXPECT_TRUE(probe.request("asip/uno1/in", "#,?")) << agent.process().errors();
}

// On the board's connection they would wait behind its reports and acknowledgements while the broker is busy.
TEST(AgentBroker, AnswerToACommand_ComesOverTheConnectionOfStops) {
    MosquittoBroker broker;
    BusProbe probe(broker.port());
    FakePort port;
    Agent agent(broker, port.path());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    probe.publish("asip/uno1/in", R"({"raw":"#,?","id":"1","reply_to":"answers/command"})");
    ASSERT_TRUE(probe.wait_for("answers/command")) << agent.process().errors();
    EXPECT_THAT(broker.log(),
                testing::ContainsRegex("Received PUBLISH from [^ ]+-stops[^ ]* .*answers/command"));
}

/// What waits for an agent, and what it does of that before it answers a command behind it.
class AgentFlood : public testing::Test {
  protected:
    static constexpr std::size_t kFlood = 5000;

    void SetUp() override { ASSERT_TRUE(wait_state(probe_, "online")) << agent_.process().errors(); }
    void flood_and_command(const std::string& topic, const std::string& payload) {
        agent_.process().signal(SIGSTOP);
        for (std::size_t i = 0; i < kFlood; ++i)
            probe_.publish(topic, payload);
        probe_.publish("asip/uno1/in", R"({"raw":"#,?","id":"1","reply_to":"answers/command"})");
        EXPECT_TRUE(wait_until([&] { return probe_.all_acknowledged(); }));
        agent_.process().signal(SIGCONT);
        EXPECT_TRUE(probe_.wait_for("answers/command")) << agent_.process().errors();
    }

    MosquittoBroker broker_{{.extra_lines = {"max_queued_messages 0"}}};
    FakePort port_;
    BusProbe probe_{broker_.port()};
    Agent agent_{broker_, port_.path()};
};

TEST_F(AgentFlood, RequestsForLinks_DelayNoCommand) {
    flood_and_command("asip/uno1/$link/olga/c1", R"({"remove":"none","id":"1","reply_to":"answers/link"})");
    EXPECT_LT(probe_.count("answers/link"), kFlood / 2);
    EXPECT_TRUE(wait_until([&] { return probe_.count("answers/link") == kFlood; }));
}

// An acknowledgement is a system call, and a broker has few messages under way that have none.
TEST_F(AgentFlood, Demands_AreNotAcknowledged) {
    flood_and_command("asip/servicebus/uno1/$demand/eve/c1", R"({"services":{"*":100},"lease":300})");
    EXPECT_LT(counted(std::to_string(agent_.process().pid()), "syscw"), kFlood / 2);
}

}  // namespace
}  // namespace asip::test
