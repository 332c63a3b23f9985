// SPDX-License-Identifier: Apache-2.0
// The broker dies while a command waits, or the user ends it: no other program is blamed, and what cannot be
// known is not guessed.
#include <gmock/gmock.h>

#include <csignal>
#include <map>

#include "tests/integration/cli/bus_fixture.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class BrokerLostTest : public BusTest {
  protected:
    void SetUp() override {
        announce("uno1");
        announce("uno2");
    }
    void TearDown() override { broker_.start(); }

    /// It waits for an answer to what it published there.
    std::unique_ptr<ChildProcess> start(const Words& words, const std::string& topic) {
        probe_.clear();
        auto child = std::make_unique<ChildProcess>(program(words), environment());
        EXPECT_TRUE(probe_.wait_for(topic)) << words.front() << ": " << child->errors();
        return child;
    }

    static void expect_lost(ChildProcess& child, const std::string& verb) {
        EXPECT_EQ(child.wait_exit(), 3) << verb << ": " << child.errors();
        EXPECT_THAT(child.output() + child.errors(),
                    HasSubstr("closed the connection, and was not back in time"))
            << verb;
        EXPECT_THAT(child.errors(), Not(HasSubstr("agent"))) << verb;
        EXPECT_THAT(child.errors(), Not(HasSubstr("access rules"))) << verb << ": it was asked a moment ago";
    }
};

TEST_F(BrokerLostTest, VerbsThatWaitForAnAnswer_SayThatTheBrokerIsLost) {
    // The first must still wait when the last has been started.
    const std::string time = "--timeout=" + std::to_string(time_limit(2s).count()) + "ms";
    std::map<std::string, std::unique_ptr<ChildProcess>> waiting;
    waiting["send"] = start({"send", "uno1/servo", "write", "0", "90", time}, "asip/uno1/servo/in");
    waiting["send to several"] =
        start({"send", "uno*/servo", "write", "0", "90", "--from-bus", time}, "asip/uno2/servo/in");
    waiting["stop"] = start({"stop", "uno1", time}, "asip/uno1/$stop");
    waiting["label"] = start({"label", "uno1", "room=lab", time}, "asip/uno1/in");
    waiting["release"] = start({"release", "uno1", time}, "asip/uno1/in");
    waiting["get"] = start({"get", "uno1/distance", time}, "asip/uno1/distance/in");
    waiting["pin"] = start({"pin", "uno1", "13", "high", time}, "asip/uno1/io/in");
    waiting["wait"] = start({"wait", "uno1", "--for", "lost", time}, "asip/servicebus/$probe");
    broker_.kill();
    for (auto& [verb, child] : waiting)
        expect_lost(*child, verb);
}

TEST_F(BrokerLostTest, Forget_ClearsNothingOfWhoCouldNotBeAsked) {
    const auto forget = start({"forget", "uno1", "--from-bus"}, "asip/uno1/in");
    broker_.kill();
    expect_lost(*forget, "forget");
    EXPECT_EQ(forget->output(), "");
    EXPECT_THAT(forget->errors(), Not(HasSubstr("forgot")));
}

TEST_F(BrokerLostTest, ForgetThatIsInterrupted_ClearsNothingEither) {
    const auto forget = start({"forget", "uno1", "--from-bus"}, "asip/uno1/in");
    forget->signal(SIGINT);
    EXPECT_EQ(forget->wait_exit(), 1);
    EXPECT_THAT(forget->errors(), HasSubstr("interrupted"));
    EXPECT_TRUE(BusProbe(broker_.port()).wait_for("asip/servicebus/uno1/$state", "online"));
}

TEST_F(BrokerLostTest, List_ClaimsNoBoards) {
    const auto list = start({"list", "--from-bus"}, "asip/servicebus/$probe");
    broker_.kill();
    expect_lost(*list, "list");
    EXPECT_EQ(list->output(), "");
}

TEST_F(BrokerLostTest, BackInTime_IsToldAndTheAnswerStillCounts) {
    const auto send =
        start({"send", "uno1/servo", "write", "0", "90", "--timeout", "30s"}, "asip/uno1/servo/in");
    const auto request = probe_.wait_for("asip/uno1/servo/in");
    ASSERT_TRUE(request);
    broker_.kill();
    EXPECT_TRUE(send->wait_for_errors("closed the connection")) << "at once";
    broker_.start();
    EXPECT_TRUE(send->wait_for_errors("connected again"));
    ASSERT_TRUE(wait_until([&] { return probe_.connected(); }));
    EXPECT_TRUE(wait_until([&] {
        answer(*request, R"({"status":"ok","proof":"fence"})");
        return send->output() == "ok\n";
    }));
    EXPECT_EQ(send->wait_exit(), 0) << send->errors();
}

}  // namespace
}  // namespace asip::test
