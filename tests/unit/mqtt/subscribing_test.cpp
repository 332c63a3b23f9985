// SPDX-License-Identifier: Apache-2.0
// Subscriptions that a broker refuses, or takes its time over, and checks of the way from the broker.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/mqtt/simulated_bus.hpp"

namespace asip::test {
namespace {

using Kind = mqtt::ConnectionFailure::Kind;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> filters(const SimulatedBroker& broker) {
    std::vector<std::string> all;
    for (const auto& each : broker.subscriptions)
        all.push_back(each.filter);
    return all;
}

TEST(Subscribing, Reconnected_AsksForAllAgainRequiredOnesFirst) {
    SimulatedBus bus;
    bus.subscribe("a");
    bus.subscribe("b", {.qos = 1, .required = true});
    ASSERT_TRUE(bus.connect());
    bus.subscribe("c");
    bus.unsubscribe("a");
    EXPECT_THAT(bus.broker().unsubscriptions, ElementsAre("a"));
    bus.close();
    ASSERT_TRUE(bus.until([&] { return bus.core.subscribed(); }));
    EXPECT_THAT(filters(bus.broker()), ElementsAre("b", "a", "c", "b", "c"));
    EXPECT_EQ(bus.subscribed_calls, 2);
}

TEST(Subscribing, RefusedTwiceThenGranted_IsTriedAgainAndReportedOnce) {
    SimulatedBus bus;
    bus.brokers[0].subscription_refusals = 2;
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    EXPECT_FALSE(bus.core.subscribed());
    EXPECT_EQ(bus.subscribed_calls, 0);
    ASSERT_TRUE(bus.until([&] { return bus.core.subscribed(); }));
    EXPECT_EQ(bus.broker().subscriptions.size(), 3u);
    EXPECT_THAT(bus.refused_filters, ElementsAre("in")) << "once for each connection";
    EXPECT_EQ(bus.subscribed_calls, 1);
    EXPECT_THAT(bus.losses, IsEmpty());
}

TEST(Subscribing, OptionalOneIsRefused_RequiredOnesMakeItSubscribed) {
    SimulatedBus bus(2);
    bus.brokers[0].refused_filter = "rest";
    bus.subscribe("in", {.qos = 1, .required = true});
    bus.subscribe("rest");
    ASSERT_TRUE(bus.connect());
    EXPECT_TRUE(bus.core.subscribed());
    bus.pass(10min);
    EXPECT_THAT(bus.losses, IsEmpty());
    EXPECT_THAT(bus.refused_filters, ElementsAre("rest"));
    bus.broker().refused_filter.clear();
    bus.pass(1min);
    EXPECT_EQ(bus.broker().subscriptions.back().filter, "rest");
    EXPECT_EQ(bus.subscribed_calls, 1);
}

TEST(Subscribing, RequiredOneIsRefusedThreeTimes_TheNextBrokerIsUsed) {
    SimulatedBus bus(2);
    bus.brokers[0].refused_filter = "in";
    bus.subscribe("in", {.qos = 1, .required = true});
    bus.start();
    ASSERT_TRUE(bus.until([&] { return bus.core.subscribed(); }));
    EXPECT_EQ(bus.brokers[0].subscriptions.size(), 3u);
    ASSERT_EQ(bus.losses.size(), 1u);
    EXPECT_EQ(bus.losses[0].kind, Kind::kRefused);
    EXPECT_THAT(bus.losses[0].text, HasSubstr("refuses the subscription to in"));
    EXPECT_EQ(bus.connects.back().broker.host, "broker1");
}

TEST(Subscribing, RequiredOneIsRefusedByTheOnlyBroker_TheConnectionIsKept) {
    SimulatedBus bus;
    bus.brokers[0].refused_filter = "in";
    bus.subscribe("in", {.qos = 1, .required = true});
    ASSERT_TRUE(bus.connect());
    bus.pass(5min);
    EXPECT_THAT(bus.losses, IsEmpty());
    EXPECT_FALSE(bus.core.subscribed());
    EXPECT_GT(bus.broker().subscriptions.size(), 8u);
}

TEST(Subscribing, BrokerRefusesQos1_IsAskedForQos0) {
    SimulatedBus bus;
    bus.brokers[0].refuses_qos_1 = true;
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    ASSERT_TRUE(bus.until([&] { return bus.core.subscribed(); }));
    EXPECT_EQ(bus.broker().subscriptions.back().options.qos, 0);
    bus.broker().refuses_qos_1 = false;
    bus.close();
    ASSERT_TRUE(bus.until([&] { return bus.core.subscribed(); }));
    EXPECT_EQ(bus.broker().subscriptions.back().options.qos, 1) << "another connection may be another broker";
}

TEST(Subscribing, NeverAnswered_IsStalledAfterItsOwnTime) {
    mqtt::Options options;
    options.subscribe_timeout = 30s;
    SimulatedBus bus(2, options);
    bus.brokers[0].answers = false;
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    bus.publish("state", "online", 1);
    bus.pass(29s);
    EXPECT_THAT(bus.losses, IsEmpty()) << "the broker is busy with it, and ack_timeout does not run";
    bus.pass(2s);
    ASSERT_EQ(bus.losses.size(), 1u);
    EXPECT_EQ(bus.losses[0].kind, Kind::kStalled);
    EXPECT_THAT(bus.losses[0].text, HasSubstr("does not answer a subscription"));
    ASSERT_TRUE(bus.until([&] { return bus.core.subscribed(); }));
    EXPECT_THAT(bus.published, ElementsAre("state")) << "sent again, to the next broker";
}

TEST(Subscribing, AnsweredLate_KeepsTheConnectionAndGivesAcknowledgementsTheirTime) {
    SimulatedBus bus;
    bus.brokers[0].answers = false;
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    bus.publish("state", "online", 1);
    bus.pass(25s);
    bus.answer_all();
    EXPECT_TRUE(bus.core.subscribed());
    EXPECT_THAT(bus.published, ElementsAre("state"));
    EXPECT_THAT(bus.losses, IsEmpty());
}

TEST(Subscribing, StallsLeftToTheKeepAlive_NothingIsGivenUp) {
    mqtt::Options options;
    options.ack_timeout = 0s;
    SimulatedBus bus(2, options);
    bus.brokers[0].answers = false;
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    bus.publish("state", "online", 1);
    bus.pass(10min);
    EXPECT_THAT(bus.losses, IsEmpty());
}

TEST(Subscribing, MessageBeforeTheAnswer_IsHandedOut) {
    SimulatedBus bus;
    bus.brokers[0].answers = false;
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    bus.deliver({.topic = "in", .payload = "!"});
    ASSERT_EQ(bus.messages.size(), 1u);
    EXPECT_EQ(bus.core.counters().received, 1u);
}

TEST(Subscribing, UnsubscribedBeforeTheAnswer_IsNotMissed) {
    SimulatedBus bus;
    bus.brokers[0].answers = false;
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    bus.unsubscribe("in");
    EXPECT_THAT(bus.broker().unsubscriptions, ElementsAre("in"));
    bus.answer_all();
    EXPECT_TRUE(bus.core.subscribed());
    EXPECT_THAT(bus.losses, IsEmpty());
}

TEST(Checking, Answered_IsReportedOneAtATime) {
    SimulatedBus bus;
    EXPECT_FALSE(bus.check()) << "not connected";
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    EXPECT_TRUE(bus.check());
    EXPECT_FALSE(bus.check());
    EXPECT_EQ(bus.checks_answered, 0);
    bus.answer_all();
    EXPECT_EQ(bus.checks_answered, 1);
    EXPECT_TRUE(bus.check());
    EXPECT_EQ(bus.checks_answered, 2);
    EXPECT_TRUE(bus.core.subscribed()) << "it is about no subscription";
    EXPECT_EQ(bus.subscribed_calls, 1);
}

TEST(Checking, UnsubscribedMeanwhile_ThatAnswerIsNotTakenForIt) {
    SimulatedBus bus;
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    bus.unsubscribe("in");
    ASSERT_TRUE(bus.check());
    bus.answer_all();
    EXPECT_EQ(bus.checks_answered, 1);
}

TEST(Checking, NoAnswer_LeavesTheConnectionAlone) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    ASSERT_TRUE(bus.check());
    bus.pass(10min);
    EXPECT_THAT(bus.losses, IsEmpty());
    EXPECT_EQ(bus.checks_answered, 0);
}

TEST(Checking, ConnectionLostBeforeTheAnswer_TheNextOneIsCheckedAnew) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    ASSERT_TRUE(bus.check());
    bus.close();
    bus.brokers[0].answers = true;
    ASSERT_TRUE(bus.until([&] { return bus.core.connected(); }));
    EXPECT_EQ(bus.checks_answered, 0);
    EXPECT_TRUE(bus.check());
    EXPECT_EQ(bus.checks_answered, 1);
}

}  // namespace
}  // namespace asip::test
