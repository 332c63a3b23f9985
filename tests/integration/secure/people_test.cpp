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
