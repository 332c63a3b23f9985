// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/mqtt/simulated_bus.hpp"

namespace asip::test {
namespace {

using testing::IsEmpty;

TEST(Stopping, Connected_SendsWhatIsQueuedWaitsForAcknowledgementsAndSaysGoodbye) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    for (int i = 0; i < 50; ++i)
        bus.publish("n", std::to_string(i), 1);
    bus.stop(5s);
    EXPECT_EQ(bus.broker().published.size(), 20u);
    EXPECT_EQ(bus.broker().goodbyes, 0);
    bus.answer_all();
    EXPECT_EQ(bus.broker().published.size(), 50u);
    EXPECT_EQ(bus.broker().goodbyes, 1);
    EXPECT_EQ(bus.stopped, 1);
    EXPECT_FALSE(bus.core.next_deadline());
}

TEST(Stopping, NothingIsReportedAfterwards) {
    SimulatedBus bus;
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    bus.publish("n", "x", 1);
    bus.stop();
    bus.deliver({.topic = "in", .payload = "late"});
    bus.answer_all();
    EXPECT_THAT(bus.messages, IsEmpty());
    EXPECT_THAT(bus.published, IsEmpty());
    EXPECT_THAT(bus.losses, IsEmpty());
    bus.stop();
    EXPECT_EQ(bus.stopped, 1);
    EXPECT_EQ(bus.publish("n", "y"), mqtt::PublishResult::kRefused);
}

TEST(Stopping, InsideOnConnected_SaysGoodbye) {
    SimulatedBus bus;
    bus.at_connect = [&] { bus.stop(); };
    bus.start();
    EXPECT_EQ(bus.stopped, 1);
    EXPECT_EQ(bus.broker().goodbyes, 1);
}

TEST(Stopping, NotConnected_EndsAtOnce) {
    SimulatedBus bus;
    bus.brokers[0].refuses = mqtt::ConnectionFailure::Kind::kUnreachable;
    bus.start();
    bus.pass(1s);
    const auto attempts = bus.brokers[0].attempts.size();
    bus.stop();
    EXPECT_EQ(bus.stopped, 1);
    bus.pass(1min);
    EXPECT_EQ(bus.brokers[0].attempts.size(), attempts);
}

TEST(Stopping, WhileConnecting_GivesTheAttemptUp) {
    SimulatedBus bus;
    bus.brokers[0].hangs = true;
    bus.start();
    bus.stop();
    EXPECT_EQ(bus.stopped, 1);
    EXPECT_EQ(bus.brokers[0].abandoned, 1);
}

TEST(Stopping, BrokerAcknowledgesNothing_SendsTheRestWithQos0AndSaysGoodbyeInTime) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    for (int i = 0; i < 29; ++i)
        bus.publish("n", std::to_string(i), 1);
    bus.stop(4s);
    bus.pass(2900ms);
    EXPECT_EQ(bus.broker().published.size(), 20u);
    bus.pass(200ms);
    ASSERT_EQ(bus.broker().published.size(), 29u);
    EXPECT_EQ(bus.broker().published.back().qos, 0);
    EXPECT_EQ(bus.broker().goodbyes, 1);
    EXPECT_EQ(bus.stopped, 1);
}

TEST(Stopping, SubscriptionHasNoAnswer_SendsWhatIsQueuedAndSaysGoodbye) {
    SimulatedBus bus;
    bus.brokers[0].answers = false;
    bus.subscribe("in");
    ASSERT_TRUE(bus.connect());
    bus.publish("state", "offline");
    bus.stop();
    EXPECT_EQ(bus.stopped, 1);
    EXPECT_EQ(bus.broker().published.size(), 1u);
    EXPECT_EQ(bus.broker().goodbyes, 1);
}

TEST(Stopping, BrokerHangs_EndsWithinTheLimit) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = bus.broker().reads = bus.broker().sees_goodbye = false;
    bus.publish("state", "busy");
    bus.publish("state", "offline", 1);
    bus.stop(800ms);
    bus.pass(700ms);
    EXPECT_EQ(bus.stopped, 0);
    bus.pass(100ms);
    EXPECT_EQ(bus.stopped, 1);
    EXPECT_EQ(bus.broker().abandoned, 1);
}

}  // namespace
}  // namespace asip::test
