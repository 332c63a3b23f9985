// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/integration/agent/fake_port.hpp"
#include "tests/integration/agent/rig.hpp"
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

}  // namespace
}  // namespace asip::test
