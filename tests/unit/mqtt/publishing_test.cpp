// SPDX-License-Identifier: Apache-2.0
// What is sent, with which QoS, and what becomes of it when the broker does not do its part.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/mqtt/simulated_bus.hpp"

namespace asip::test {
namespace {

using Kind = mqtt::ConnectionFailure::Kind;
using mqtt::Priority;
using mqtt::PublishResult;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> payloads(const SimulatedBroker& broker) {
    std::vector<std::string> all;
    for (const auto& each : broker.published)
        all.push_back(each.payload);
    return all;
}

std::ptrdiff_t with_qos_1(const SimulatedBroker& broker) {
    return std::count_if(broker.published.begin(), broker.published.end(),
                         [](const auto& each) { return each.qos == 1; });
}

TEST(Publishing, NotConnected_WaitsAndIsSentInOrder) {
    SimulatedBus bus;
    EXPECT_EQ(bus.publish("n", "0", 1), PublishResult::kQueued);
    EXPECT_EQ(bus.publish("n", "1"), PublishResult::kQueued);
    EXPECT_EQ(bus.core.counters().queued, 2u);
    ASSERT_TRUE(bus.connect());
    EXPECT_THAT(payloads(bus.broker()), ElementsAre("0", "1"));
    EXPECT_EQ(bus.publish("n", "2"), PublishResult::kSent);
    EXPECT_EQ(bus.core.counters().queued, 0u);
    EXPECT_EQ(bus.core.counters().published, 3u);
    EXPECT_THAT(bus.published, ElementsAre("n")) << "of QoS 1 only";
}

TEST(Publishing, BrokerLost_SendsAgainWhatItDidNotAcknowledge) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    for (int i = 0; i < 3; ++i)
        bus.publish("kept", std::to_string(i), 1);
    bus.close();
    for (int i = 3; i < 100; ++i)
        bus.publish("kept", std::to_string(i), 1);
    bus.brokers[0].answers = true;
    bus.brokers[0].published.clear();
    ASSERT_TRUE(bus.until([&] { return bus.core.connected(); }));
    EXPECT_EQ(bus.published.size(), 100u);
    ASSERT_EQ(bus.broker().published.size(), 100u);
    for (std::size_t i = 0; i < 100; ++i)
        EXPECT_EQ(bus.broker().published[i].payload, std::to_string(i));
}

TEST(Publishing, AcknowledgementsMissing_NoMoreThanTheWindowIsSent) {
    for (const std::size_t receive_maximum : {65535u, 3u}) {
        SimulatedBus bus;
        bus.brokers[0].receive_maximum = receive_maximum;
        ASSERT_TRUE(bus.connect());
        bus.broker().answers = false;
        for (int i = 0; i < 30; ++i)
            bus.publish("n", std::to_string(i), 1);
        const auto window = std::min<std::size_t>(20, receive_maximum);
        EXPECT_EQ(bus.broker().published.size(), window);
        EXPECT_EQ(bus.core.counters().unacknowledged, window);
        bus.answer_all();
        EXPECT_EQ(bus.published.size(), 30u);
    }
}

TEST(Publishing, SocketFull_WaitsUntilTheBrokerReads) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    bus.broker().reads = false;
    for (int i = 0; i < 5; ++i)
        bus.publish("n", std::to_string(i));
    EXPECT_THAT(payloads(bus.broker()), ElementsAre("0"));
    bus.read_all();
    EXPECT_THAT(payloads(bus.broker()), ElementsAre("0", "1", "2", "3", "4"));
}

TEST(Publishing, FloodWhileTheBrokerReadsNothing_DropsTheOldestContextAndKeepsReplies) {
    mqtt::Options options;
    options.max_queued_messages = 100;
    SimulatedBus bus(1, options);
    ASSERT_TRUE(bus.connect());
    bus.broker().reads = false;
    for (int i = 0; i < 3000; ++i) {
        bus.publish("context", std::to_string(i));
        if (i % 100 == 0)
            bus.publish({.topic = "reply", .payload = std::to_string(i), .qos = 1}, Priority::kReply);
    }
    EXPECT_LE(bus.core.counters().queued, 100u);
    const auto dropped = bus.core.counters().dropped_context;
    EXPECT_GT(dropped, 2800u);
    bus.read_all();
    EXPECT_EQ(with_qos_1(bus.broker()), 30);
    EXPECT_EQ(bus.broker().published.size(), 3030 - dropped);
    EXPECT_EQ(bus.broker().published.back().payload, "2999");
}

TEST(Publishing, NothingAcknowledged_IsStalledAndTheNextBrokerGetsTheNewestState) {
    SimulatedBus bus(2);
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    bus.publish("state", "1", 1, true);
    bus.pass(7s);
    EXPECT_THAT(bus.losses, IsEmpty());
    bus.brokers[1].hangs = true;
    bus.pass(2s);
    ASSERT_EQ(bus.losses.size(), 1u);
    EXPECT_EQ(bus.losses[0].kind, Kind::kStalled);
    EXPECT_THAT(bus.losses[0].text, HasSubstr("acknowledges nothing any more"));
    bus.publish("state", "2", 1, true);
    bus.brokers[1].hangs = false;
    ASSERT_TRUE(bus.until([&] { return bus.brokers[1].connects > 0 || bus.brokers[0].connects > 1; }));
    bus.answer_all();
    EXPECT_EQ(bus.broker().published.back().payload, "2");
    EXPECT_EQ(bus.core.counters().queued, 0u);
    EXPECT_EQ(bus.core.counters().unacknowledged, 0u);
}

TEST(Publishing, RetainedMessagesCome_AcknowledgementsMayTakeLonger) {
    SimulatedBus bus;
    bus.subscribe("t");
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    bus.publish("state", "online", 1);
    for (int i = 0; i < 20; ++i) {
        bus.pass(1s);
        bus.deliver({.topic = "t", .payload = "stored", .retain = true});
    }
    EXPECT_THAT(bus.losses, IsEmpty());
    for (int i = 0; i < 9; ++i) {
        bus.deliver({.topic = "t", .payload = "live"});
        bus.pass(1s);
    }
    EXPECT_EQ(bus.losses.size(), 1u) << "what others publish says nothing about acknowledgements";
}

TEST(Publishing, ProgramReadsSlowly_TheBrokerIsNotBlamed) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    bus.broker().answers = false;
    bus.publish("out", "behind all that", 1);
    bus.unread = true;
    bus.pass(1min);
    EXPECT_THAT(bus.losses, IsEmpty());
    bus.unread = false;
    bus.pass(7s);
    EXPECT_THAT(bus.losses, IsEmpty());
    bus.pass(2s);
    EXPECT_EQ(bus.losses.size(), 1u);
}

TEST(Publishing, BrokerAllowsQos0Only_IsUsedWithQos0) {
    mqtt::Options options;
    options.will = mqtt::Message{.topic = "state", .payload = "lost", .qos = 1};
    SimulatedBus bus(1, options);
    bus.brokers[0].max_qos = 0;
    bus.subscribe("in");
    bus.publish("out", "on", 1);
    ASSERT_TRUE(bus.connect());
    EXPECT_THAT(bus.failures, IsEmpty());
    EXPECT_EQ(bus.broker().attempts.size(), 2u) << "the will was refused first";
    EXPECT_EQ(bus.broker().attempts.back().will->qos, 0);
    EXPECT_EQ(bus.broker().subscriptions.at(0).options.qos, 0);
    EXPECT_EQ(bus.broker().published.at(0).qos, 0);
    EXPECT_THAT(bus.published, ElementsAre("out")) << "handed over";
}

TEST(Publishing, Qos1MessageThatCouldNotBeSentWithQos0_KeepsItsQos) {
    SimulatedBus bus(2);
    bus.brokers[0].max_qos = 0;
    bus.brokers[0].reads = false;
    bus.start();
    bus.publish("out", "1", 1);
    bus.pass(10s);
    bus.cut_off();
    ASSERT_TRUE(bus.until([&] { return bus.brokers[1].published.size() == 1; }));
    EXPECT_EQ(bus.broker().published[0].qos, 1);
}

/// A cluster of RabbitMQ says so of each topic to which a dead node had a subscription.
TEST(Publishing, ErrorWithoutAReason_IsNoRefusal) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    bus.broker().publish_code = 131;
    bus.publish("delivered", "0", 1);
    EXPECT_THAT(bus.denied, IsEmpty());
    EXPECT_THAT(bus.published, ElementsAre("delivered"));
    bus.broker().publish_code = 135;
    bus.publish("denied", "1", 1);
    EXPECT_THAT(bus.denied, ElementsAre("denied"));
    EXPECT_THAT(bus.published, ElementsAre("delivered"));
}

TEST(Publishing, TopicThatMqttCannotCarry_IsRefused) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    for (const auto& topic : {std::string("a/+"), std::string("#"), std::string(), std::string("a\0b", 3),
                              std::string("\xff\xfe")})
        EXPECT_EQ(bus.publish(topic, "x"), PublishResult::kRefused);
    EXPECT_EQ(bus.publish({.topic = "t", .payload = "x", .qos = 2}), PublishResult::kRefused);
    EXPECT_EQ(bus.core.counters().refused, 6u);
    EXPECT_EQ(bus.publish("good", "x"), PublishResult::kSent);
    EXPECT_EQ(bus.broker().published.size(), 1u);
}

}  // namespace
}  // namespace asip::test
