// SPDX-License-Identifier: Apache-2.0
// What the agent of one board may do, and what it may not.
#include "tests/integration/secure/secured_bus.hpp"

namespace asip::test {
namespace {

class BoardOnSecuredBus : public SecuredBus {
  protected:
    BoardOnSecuredBus() {
        add({"board", "uno1", "uno2"});
        add({"operator", "ann"});
        start_broker();
    }
};

TEST_F(BoardOnSecuredBus, SpeaksForItselfAndReceivesWhatItIsAsked) {
    for (const char* topic :
         {"asip/servicebus/uno1", "asip/servicebus/uno1/$state", "asip/servicebus/uno1/$description",
          "asip/uno1/out", "asip/uno1/io/out", "asip/uno1/io/error", "asip/servicebus/$probe",
          "asip/reply/ann/uno1/x", "asip/reply/gateway/uno1/x/session"})
        EXPECT_TRUE(may_publish("uno1", topic)) << topic;
    for (const char* topic : {"asip/uno1/in", "asip/uno1/io/in", "asip/uno1/$stop", "asip/servicebus/$probe",
                              "asip/servicebus/uno1/$state"})
        EXPECT_TRUE(may_read("uno1", topic)) << topic;
}

TEST_F(BoardOnSecuredBus, CannotAnnounceAnother) {
    for (const char* topic : {"asip/servicebus", "asip/servicebus/uno2", "asip/servicebus/uno2/$state",
                              "asip/servicebus/uno2/$description", "asip/servicebus/uno2/$stats",
                              "asip/servicebus/uno11/$state", "asip/registry/hall/$state"})
        EXPECT_FALSE(may_publish("uno1", topic)) << topic;
}

TEST_F(BoardOnSecuredBus, CannotPublishForAnother) {
    for (const char* topic : {"asip/uno2/out", "asip/uno2/io/out", "asip/uno2/io/error", "asip/uno11/out",
                              "asip/other", "elsewhere"})
        EXPECT_FALSE(may_publish("uno1", topic)) << topic;
}

TEST_F(BoardOnSecuredBus, CannotAnswerForAnotherNorForARegistry) {
    for (const char* topic : {"asip/reply/ann/uno2/x", "asip/reply/ann/uno2", "asip/reply/ann/uno11/x",
                              "asip/reply/ann/x/uno1", "asip/reply/ann", "asip/reply/ann/registry/x",
                              "asip/reply/ann/$self/x", "asip/reply/$nobody/uno2/x", "asip/reply"})
        EXPECT_FALSE(may_publish("uno1", topic)) << topic;
}

TEST_F(BoardOnSecuredBus, CannotCommandAnotherNorReadWhatOthersAreAskedOrAnswer) {
    for (const char* topic : {"asip/uno2/in", "asip/uno2/io/in", "asip/uno2/$stop", "asip/registry/query"})
        EXPECT_FALSE(may_publish("uno1", topic)) << topic;
    for (const char* topic : {"asip/uno2/in", "asip/uno2/io/in", "asip/uno2/$stop", "asip/uno2/io/out",
                              "asip/reply/ann/uno2/x", "asip/reply/ann/uno1/x", "asip/registry/query"})
        EXPECT_FALSE(may_read("uno1", topic)) << topic;
}

}  // namespace
}  // namespace asip::test
