// SPDX-License-Identifier: Apache-2.0
// From an open bus to a secured one, with the programs as they are shipped.
#include <gmock/gmock.h>

#include <csignal>

#include "tests/integration/client/simulated_boards.hpp"
#include "tests/integration/secure/secured_bus.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class WalkOnSecuredBus : public SecuredBus {
  protected:
    WalkOnSecuredBus() {
        add({"board", "uno"});
        add({"operator", "ann"});
        add({"viewer", "bob"});
        add({"registry"});
        start_broker();
        agent_ =
            std::make_unique<ChildProcess>(Words{ASIP_TEST_AGENT, "--serial", boards_.serial()} + as("uno"));
        registry_ =
            std::make_unique<ChildProcess>(Words{ASIP_TEST_REGISTRY, "--id", "hall"} + as("registry"));
    }
    Finished asipctl(const std::string& user, const Words& words) const {
        return run(Words{ASIP_TEST_ASIPCTL} + words + as(user));
    }
    bool listed_for(const std::string& user) const {
        return wait_until(
            [&] { return asipctl(user, {"list", "--state", "online", "-o", "name"}).output == "uno\n"; });
    }

    SimulatedBoards boards_{{"asip_uno"}};
    std::unique_ptr<ChildProcess> agent_, registry_;
};

TEST_F(WalkOnSecuredBus, OneFileEach_IsAllThatAgentRegistryAndPeopleNeed) {
    ASSERT_TRUE(listed_for("bob")) << agent_->errors() << registry_->errors();
    const auto sent = asipctl("ann", {"send", "uno/io", "write", "13", "1"});
    const auto pin = asipctl("ann", {"pin", "uno", "13", "high"});
    EXPECT_EQ(pin.status, 0) << pin.errors << sent.errors;
    EXPECT_TRUE(boards_.wait_for_led("on"));
    EXPECT_THAT(agent_->errors(), Not(HasSubstr("refuse"))) << "nothing that it does is denied";
    EXPECT_THAT(agent_->errors(), Not(HasSubstr("denied")));
    EXPECT_THAT(registry_->errors(), Not(HasSubstr("access rules")));
    EXPECT_THAT(agent_->errors(), Not(HasSubstr("lost")));
}

TEST_F(WalkOnSecuredBus, ViewerWhoCommands_IsToldWhoWhatAndWhoMayGrantIt) {
    ASSERT_TRUE(listed_for("bob")) << agent_->errors() << registry_->errors();
    const auto refused = asipctl("bob", {"send", "uno", "--raw", "I,P,13,3"});
    EXPECT_EQ(refused.status, 1) << refused.errors;
    EXPECT_THAT(refused.errors, HasSubstr("does not let user bob write to asip/uno/in"));
    EXPECT_THAT(refused.errors, HasSubstr("asipctl secure add operator"));
    EXPECT_THAT(refused.errors, Not(HasSubstr("no answer")));
    const auto stop = asipctl("bob", {"stop", "uno"});
    EXPECT_EQ(stop.status, 1) << stop.errors;
    EXPECT_THAT(stop.errors, HasSubstr("does not let user bob write to asip/uno/$stop"));
    EXPECT_THAT(stop.errors, Not(HasSubstr("no agent answered")));
}

TEST_F(WalkOnSecuredBus, ViewerWhoSubscribes_MayDemandValues_InItsOwnNameOnly) {
    agent_->signal(SIGTERM);
    agent_->wait_exit();
    agent_ = std::make_unique<ChildProcess>(
        Words{ASIP_TEST_AGENT, "--serial", boards_.serial(), "--reports", "on-demand"} + as("uno"));
    ASSERT_TRUE(listed_for("bob")) << agent_->errors() << registry_->errors();
    ASSERT_EQ(asipctl("ann", {"pin", "uno", "A0", "analog"}).status, 0);
    const auto seen = asipctl("bob", {"subscribe", "uno/io", "--max-hz", "5", "-n", "2", "-W", "20"});
    EXPECT_EQ(seen.status, 0) << seen.errors << agent_->errors();
    EXPECT_THAT(seen.errors, Not(HasSubstr("does not let")));
    EXPECT_TRUE(may_publish("bob", "asip/servicebus/uno/$demand/bob/c1"));
    for (const char* topic : {"asip/servicebus/uno/$demand/ann/c1", "asip/servicebus/uno/$demand",
                              "asip/servicebus/uno/$demand/x"})
        EXPECT_FALSE(may_publish("bob", topic)) << topic;
    EXPECT_FALSE(may_publish("uno", "asip/servicebus/uno2/$demand/uno/c1")) << "a board demands nothing";
}

TEST_F(WalkOnSecuredBus, BoardWithoutAgent_IsFoundByItsServicesAndCannotNameAnother) {
    add({"board", "plain"});
    ASSERT_TRUE(listed_for("bob")) << agent_->errors() << registry_->errors();
    auto board = probe("plain", {"asip/plain/in"});
    board.publish("asip/servicebus/plain", "io");
    EXPECT_TRUE(wait_until([&] { return asipctl("bob", {"list", "-o", "name"}).output == "plain\nuno\n"; }))
        << registry_->errors();
    board.publish("asip/servicebus", "forged");
    auto again = probe("plain", {});
    again.publish("asip/servicebus/plain", "io");
    ASSERT_TRUE(wait_until([&] { return again.all_acknowledged(); }));
    EXPECT_EQ(asipctl("bob", {"list", "-o", "name"}).output, "plain\nuno\n");
}

TEST_F(WalkOnSecuredBus, Doctor_SaysThatItIsClosed) {
    const auto looked = asipctl("ann", {"doctor"});
    EXPECT_THAT(looked.output, HasSubstr("lets in known users only"));
    EXPECT_THAT(looked.output, Not(HasSubstr("the bus is open")));
}

TEST_F(WalkOnSecuredBus, ViewersRefusedRequest_IsNotTakenForSilence) {
    ASSERT_TRUE(listed_for("bob")) << agent_->errors() << registry_->errors();
    const auto looked = asipctl("bob", {"doctor"});
    EXPECT_THAT(looked.output, HasSubstr("not asked: uno; the broker does not let us command boards"));
    EXPECT_THAT(looked.output, Not(HasSubstr("gone or stuck")));
    for (const Words& words : {Words{"pin", "uno", "13", "high"}, Words{"release", "uno"},
                               Words{"send", "uno/io", "write", "13", "1", "--hold", "1s"}}) {
        const auto refused = asipctl("bob", words);
        EXPECT_EQ(refused.status, 1) << words.front() << refused.errors;
        EXPECT_THAT(refused.errors, HasSubstr("does not let user bob write to asip/uno/")) << words.front();
        EXPECT_THAT(refused.errors, Not(HasSubstr("no answer"))) << words.front();
    }
}

TEST_F(WalkOnSecuredBus, CommandLine_GoesBeforeCredentialsAndTheseBeforeTheEnvironment) {
    const auto listed = run(Words{ASIP_TEST_ASIPCTL, "list"} + as("ann"),
                            {{"ASIP_USER", "nobody"}, {"ASIP_PASSWORD_FILE", "/nonexistent"}});
    EXPECT_EQ(listed.status, 0) << listed.errors;
    const auto by_environment = run({ASIP_TEST_ASIPCTL, "list"}, {{"ASIP_CREDENTIALS", credentials("ann")}});
    EXPECT_EQ(by_environment.status, 0) << by_environment.errors;
    const auto elsewhere =
        run(Words{ASIP_TEST_ASIPCTL, "list", "--broker", "mqtts://127.0.0.1:" + std::to_string(free_port())} +
            as("ann"));
    EXPECT_EQ(elsewhere.status, 3);
}

TEST(OpenBus, Doctor_SaysSoAndWhatToRun) {
    MosquittoBroker broker;
    const auto looked = run({ASIP_TEST_ASIPCTL, "doctor", "--broker", broker.address()});
    EXPECT_THAT(looked.output, HasSubstr("the bus is open"));
    EXPECT_THAT(looked.output, HasSubstr("asipctl secure init"));
}

}  // namespace
}  // namespace asip::test
