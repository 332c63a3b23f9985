// SPDX-License-Identifier: Apache-2.0
// Operators, viewers, registries and strangers.
#include <csignal>

#include "tests/integration/secure/secured_bus.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {
namespace {

class PeopleOnSecuredBus : public SecuredBus {
  protected:
    PeopleOnSecuredBus() {
        add({"board", "uno1"});
        add({"operator", "ann"});
        add({"viewer", "bob"});
        add({"registry"});
        add({"gateway"});
        start_broker();
    }
};

TEST_F(PeopleOnSecuredBus, Viewer_SeesBoardsAndCannotCommandThem) {
    for (const char* topic : {"asip/servicebus/uno1/$state", "asip/uno1/out", "asip/uno1/io/out",
                              "asip/uno1/io/error", "asip/registry/hall/events"})
        EXPECT_TRUE(may_read("bob", topic)) << topic;
    for (const char* topic : {"asip/uno1/in", "asip/uno1/io/in", "asip/uno1/$stop", "asip/uno1/out",
                              "asip/servicebus/uno1/$state"})
        EXPECT_FALSE(may_publish("bob", topic)) << topic;
}

TEST_F(PeopleOnSecuredBus, Viewer_CannotSeeAnswersOrRequestsOfOthers) {
    for (const char* topic : {"asip/reply/ann/uno1/x", "asip/reply/gateway/uno1/x/s", "asip/uno1/in",
                              "asip/uno1/io/in", "asip/uno1/$stop", "asip/registry/query"})
        EXPECT_FALSE(may_read("bob", topic)) << topic;
}

TEST_F(PeopleOnSecuredBus, AnswersToAnOperator_AreForgedByNobody) {
    for (const char* user : {"bob", "gateway", "registry"})
        for (const char* topic : {"asip/reply/ann/uno1/x", "asip/reply/ann/uno1", "asip/reply/ann/$self/x",
                                  "asip/reply/ann/x", "asip/reply/ann"})
            EXPECT_FALSE(may_publish(user, topic)) << user << " " << topic;
    for (const char* user : {"uno1", "bob", "gateway"})
        EXPECT_FALSE(may_publish(user, "asip/reply/ann/registry/x")) << user;
    EXPECT_TRUE(may_publish("uno1", "asip/reply/ann/uno1/x")) << "who is asked answers";
    EXPECT_TRUE(may_publish("registry", "asip/reply/ann/registry/x"));
    EXPECT_FALSE(may_publish("gateway", "asip/reply/ann/gateway/x")) << "is no board";
}

TEST_F(PeopleOnSecuredBus, Registry_ClearsWhatBoardsLeftAndNothingElse) {
    for (const char* topic : {"asip/servicebus/gone", "asip/servicebus/gone/$state",
                              "asip/servicebus/gone/$description", "asip/gone/out", "asip/gone/io/out",
                              "asip/gone/io/error", "asip/registry/hall/$state", "asip/registry/hall/events"})
        EXPECT_TRUE(may_publish("registry", topic)) << topic;
    for (const char* topic : {"asip/gone", "asip/gone/io", "asip/gone/io/other", "elsewhere",
                              "homeassistant/x", "asip/servicebus"})
        EXPECT_FALSE(may_publish("registry", topic)) << topic;
    for (const char* topic : {"asip/uno1/in", "asip/uno1/io/in", "asip/uno1/$stop"}) {
        EXPECT_FALSE(may_publish("registry", topic)) << "commands nobody: " << topic;
        EXPECT_FALSE(may_read("registry", topic)) << topic;
    }
    EXPECT_FALSE(may_read("registry", "asip/reply/ann/uno1/x"));
}

TEST_F(PeopleOnSecuredBus, StrangersGetNothing) {
    const auto ann = probe_options("ann");
    EXPECT_TRUE(may_connect({"--cafile", ann.ca, "-u", "ann", "-P", ann.password})) << "the test can tell";
    EXPECT_FALSE(may_connect({"--cafile", ann.ca})) << "anonymous";
    EXPECT_FALSE(may_connect({"--cafile", ann.ca, "-u", "ann"})) << "without password";
    EXPECT_FALSE(may_connect({"--cafile", ann.ca, "-u", "ann", "-P", "wrong"}));
    EXPECT_FALSE(may_connect({"--cafile", ann.ca, "-u", "ann", "-P", probe_options("bob").password}));
    EXPECT_FALSE(may_connect({"--cafile", ann.ca, "-u", "eve", "-P", ann.password})) << "unknown";
    EXPECT_FALSE(may_connect({"-u", "ann", "-P", ann.password})) << "without TLS";
    TempDir other;
    const auto strange = make_certificates(other);
    EXPECT_FALSE(
        may_connect({"--cafile", ann.ca, "--cert", strange.client_cert, "--key", strange.client_key}))
        << "a certificate of somebody else";
    EXPECT_FALSE(may_connect({"--cafile", strange.ca, "-u", "ann", "-P", ann.password}))
        << "the broker does not pass for one of another authority";
}

TEST_F(PeopleOnSecuredBus, Check_FindsTheRulesKept) {
    const auto checked = secure({"check", "-o", "jsonl"});
    EXPECT_EQ(checked.status, 0) << checked.output << checked.errors;
    EXPECT_EQ(checked.output.find("not tried"), std::string::npos) << checked.output;
    EXPECT_NE(checked.output.find("command boards"), std::string::npos);
}

TEST_F(PeopleOnSecuredBus, Check_FindsABrokerThatAllowsMore) {
    TempDir more;
    const auto rules = run({"cat", file("broker/rules.acl")}).output;
    ASSERT_EQ(run({"sh", "-c", "printf 'pattern write asip/#\\n' >> " + file("broker/rules.acl")}).status, 0);
    broker_->signal(SIGHUP);
    ASSERT_TRUE(wait_until([&] { return may_publish("bob", "asip/uno1/in"); }));
    const auto checked = secure({"check", "bob", "-o", "jsonl"});
    EXPECT_EQ(checked.status, 1) << checked.output;
    EXPECT_NE(checked.output.find(
                  R"("is":"allowed","name":"bob","role":"viewer","should":"denied","what":"command boards")"),
              std::string::npos)
        << checked.output;
}

TEST_F(PeopleOnSecuredBus, HomeAssistant_IsToldWhatItsFormsAskFor) {
    const auto added = secure({"add", "home-assistant"});
    ASSERT_EQ(added.status, 0) << added.errors;
    const auto next = added.output.substr(added.output.find("Next:"));
    for (const auto& needed :
         Words{"broker ", "port ", credentials("home-assistant"), file("ca.crt"), "Add integration"})
        EXPECT_NE(next.find(needed), std::string::npos) << needed << "\n" << next;
    const auto renewed = secure({"renew", "home-assistant"});
    ASSERT_EQ(renewed.status, 0) << renewed.errors;
    EXPECT_NE(renewed.output.find(file("ca.crt")), std::string::npos) << renewed.output;
}

}  // namespace
}  // namespace asip::test
