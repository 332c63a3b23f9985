// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "simulated_program.hpp"

namespace asip::caller {
namespace {

using testing::Contains;
using testing::ElementsAre;

class BoardTest : public testing::Test, protected SimulatedProgram {
  protected:
    void SetUp() override {
        caller->watch("uno1");
        connect();
    }
    std::string description(int seq, const std::string& state = "online") const {
        return json{{"board", "uno1"},
                    {"session", "0000000000000001"},
                    {"seq", seq},
                    {"lease", 30},
                    {"state", {{"is", state}, {"age", 0}}},
                    {"services", json::array()},
                    {"on_demand", {{"hz", 10}}}}
            .dump();
    }
    std::string state() {
        const auto item = caller->boards().board("uno1", {now, {}});
        return item ? item->state : "none";
    }
};

TEST_F(BoardTest, Watching_SubscribesOnce) {
    caller->watch("uno1");
    EXPECT_THAT(subscribed, ElementsAre("asip/reply/ann/+/me", "asip/servicebus/uno1/$state",
                                        "asip/servicebus/uno1/$description"));
}

TEST_F(BoardTest, StoredWords_AreCompleteOnceTheStateHasCome) {
    receive("asip/servicebus/uno1/$description", description(1), true);
    EXPECT_FALSE(caller->heard_of("uno1"));
    receive("asip/servicebus/uno1/$state", "online", true);
    EXPECT_TRUE(caller->heard_of("uno1"));
    EXPECT_EQ(state(), "online");
    EXPECT_THAT(changed, Contains("uno1"));
}

TEST_F(BoardTest, BoardOfNamesAlone_IsSeenByItsName) {
    caller->watch_all();
    receive("asip/servicebus", "pico");
    EXPECT_THAT(caller->boards().names(), ElementsAre("pico"));
    EXPECT_THAT(changed, ElementsAre("pico"));
}

TEST_F(BoardTest, LostConnection_JudgesNoLeaseAndHearsAgain) {
    receive("asip/servicebus/uno1/$description", description(1));
    EXPECT_TRUE(caller->heard_of("uno1"));
    lose();
    pass(5min);
    EXPECT_FALSE(caller->heard_of("uno1"));
    EXPECT_EQ(state(), "online");
    connect();
    receive("asip/servicebus/uno1/$description", description(9));
    EXPECT_TRUE(caller->heard_of("uno1"));
}

TEST_F(BoardTest, LeaseThatRunsOut_IsTold) {
    receive("asip/servicebus/uno1/$description", description(1));
    changed.clear();
    pass(2min);
    EXPECT_EQ(state(), "lost");
    EXPECT_THAT(changed, Contains("uno1"));
}

TEST_F(BoardTest, Demand_IsToldAnewOverEachConnectionAndEnds) {
    const std::string topic = "asip/servicebus/uno1/$demand/ann/me";
    receive("asip/servicebus/uno1/$description", description(1));
    auto want = caller->want("uno1", "distance", 20);
    caller->tick(now);
    pass(1s);
    const auto first = taken(topic);
    ASSERT_FALSE(first.empty());
    EXPECT_EQ(json::parse(first[0].payload).at("services"), (json{{"distance", 20}}));
    lose();
    pass(1min);
    EXPECT_TRUE(taken(topic).empty());
    connect();
    pass(1s);
    EXPECT_FALSE(taken(topic).empty());
    want.reset();
    caller->tick(now);
    pass(1s);
    const auto last = taken(topic);
    ASSERT_FALSE(last.empty());
    EXPECT_EQ(json::parse(last.back().payload).at("services"), json::object());
}

TEST_F(BoardTest, Leaving_SaysThatNothingIsWanted) {
    receive("asip/servicebus/uno1/$description", description(1));
    const auto want = caller->want("uno1", "distance", 20);
    caller->tick(now);
    pass(1s);
    sent.clear();
    caller->leave();
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(json::parse(sent[0].payload).at("services"), json::object());
}

TEST_F(BoardTest, Mark_PassesOnceItHasComeBack) {
    auto mark = caller->mark_retained();
    EXPECT_FALSE(mark.passed());
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(sent[0].qos, 1) << "it must not overtake messages of QoS 1";
    pass(7ms);
    receive(sent[0].topic, sent[0].payload);
    EXPECT_EQ(mark.passed_at(), now);
    mark = {};
    EXPECT_THAT(unsubscribed, ElementsAre(sent[0].topic));
}

TEST_F(BoardTest, Subscription_IsToldAsLongAsItsHandleLives) {
    std::vector<std::string> heard;
    auto subscription = caller->subscribe(
        "asip/uno1/+/out", [&](const mqtt::Message& message) { heard.push_back(message.topic); });
    receive("asip/uno1/distance/out", "{}");
    receive("asip/uno2/distance/out", "{}");
    subscription = {};
    receive("asip/uno1/distance/out", "{}");
    EXPECT_THAT(heard, ElementsAre("asip/uno1/distance/out"));
    EXPECT_THAT(unsubscribed, ElementsAre("asip/uno1/+/out"));
}

}  // namespace
}  // namespace asip::caller
