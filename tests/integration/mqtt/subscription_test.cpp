// SPDX-License-Identifier: Apache-2.0
// A scripted broker that refuses subscriptions, or takes its time over them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/integration/mqtt/recorder.hpp"
#include "tests/integration/mqtt/scripted_broker.hpp"

namespace asip::test {
namespace {

using Kind = mqtt::ConnectionFailure::Kind;
using testing::ElementsAre;

class SubscriptionTest : public testing::Test {
  protected:
    mqtt::Options options() {
        mqtt::Options made;
        made.brokers = {{"127.0.0.1", broker.port(), false}};
        made.version = mqtt::Version::kV5;
        return made;
    }
    template <class Condition>
    bool until(Recorder& bus, Condition condition, std::chrono::milliseconds limit = kDeadline) {
        return until_beside(bus, condition, limit, broker);
    }

    ScriptedBroker broker;
};

TEST_F(SubscriptionTest, RefusedTwiceThenGranted_IsTriedAgainAndReported) {
    broker.refuse_subscriptions(2);
    Recorder bus(options());
    bus.client->subscribe("asip/uno1/+/in", {.qos = 1});
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return !bus.refused_filters.empty(); }));
    EXPECT_TRUE(bus.client->connected());
    EXPECT_FALSE(bus.client->subscribed());
    ASSERT_TRUE(until(bus, [&] { return bus.client->subscribed(); }));
    EXPECT_EQ(broker.subscriptions, 3);
    EXPECT_THAT(bus.refused_filters, ElementsAre("asip/uno1/+/in")) << "once for each connection";
    EXPECT_EQ(bus.subscribed_calls, 1);
    EXPECT_TRUE(bus.losses.empty());
}

TEST_F(SubscriptionTest, RestIsAnsweredLater_ReportedOnceMoreThen) {
    broker.refuse_filter("rest");
    Recorder bus(options());
    bus.client->subscribe("in", {.qos = 1, .required = true});
    bus.client->subscribe("rest", {.qos = 1});
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return !bus.refused_filters.empty(); }));
    EXPECT_TRUE(bus.client->subscribed());
    EXPECT_EQ(bus.subscribed_calls, 1);
    EXPECT_EQ(bus.all_subscribed_calls, 0);
    broker.refuse_filter("");
    ASSERT_TRUE(until(bus, [&] { return bus.all_subscribed_calls > 0; }));
    EXPECT_EQ(bus.subscribed_calls, 1);
    EXPECT_EQ(bus.all_subscribed_calls, 1);
}

TEST_F(SubscriptionTest, BusyBrokerOfAList_RestIsAskedForAsLongAgainLater) {
    broker.answer_nothing_after_connect();
    auto both = options();
    both.version = mqtt::Version::kV311;
    both.brokers.push_back({"127.0.0.1", 1, false});  // nobody is there
    Recorder bus(both);
    bus.client->subscribe("in", {.qos = 1, .required = true});
    bus.client->subscribe("rest", {.qos = 1});
    bus.client->start();
    const auto asked_for_the_rest = [&] { return broker.subscriptions > 1; };
    EXPECT_FALSE(until(bus, asked_for_the_rest, 2s));
    broker.answer_all();
    ASSERT_TRUE(until(bus, [&] { return bus.client->subscribed(); }));
    EXPECT_FALSE(until(bus, asked_for_the_rest, 500ms));
    EXPECT_TRUE(until(bus, [&] { return bus.all_subscribed_calls > 0; }));
    EXPECT_EQ(broker.subscriptions, 2);
}

TEST_F(SubscriptionTest, MessageOfQos1_IsHandedOutBeforeItIsAcknowledged) {
    broker.publish_to_subscriber();
    Recorder bus(options());
    int before = -1;
    bus.at_message = [&](const mqtt::Message&) {
        broker.run();
        before = broker.acknowledgements;
    };
    bus.client->subscribe("t", {.qos = 1});
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return broker.acknowledgements == 1; }));
    EXPECT_EQ(before, 0);
}

TEST_F(SubscriptionTest, ClosedTwiceRightAfterSending_ComesBackUnderAnotherIdentifier) {
    broker.close_publisher("asip-lamp");
    auto made = options();
    made.client_id = "asip-lamp";
    made.retry_first = 5ms;
    made.brokers.push_back({"127.0.0.1", 1, false});  // nobody is there
    Recorder bus(made);
    std::vector<std::string> identifiers;
    bus.at_connect = [&] {
        identifiers.push_back(broker.identifier("asip-lamp"));
        bus.client->publish(make_message("asip/lamp", "on", 1));
    };
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return !bus.published.empty(); }));
    ASSERT_EQ(identifiers.size(), 3U);
    EXPECT_THAT(identifiers, ElementsAre(testing::MatchesRegex("asip-lamp-[0-9a-f]{16}"), identifiers[0],
                                         testing::MatchesRegex(identifiers[0] + "-[0-9a-f]{4}")));
    EXPECT_EQ(bus.connects[2].client_id, "asip-lamp");
    EXPECT_TRUE(bus.failures.empty()) << "the broker that closed it is where another identifier is tried";
}

// As NATS does after a node was lost.
TEST_F(SubscriptionTest, ClosedWithoutAnAcknowledgementForLong_ComesBackWithQos0) {
    broker.store_nothing(3500ms);
    auto made = options();
    made.version = mqtt::Version::kV311;
    made.client_id = "asip-lamp";
    made.will = make_message("asip/lamp/state", "lost", 1);
    Recorder bus(made);
    bus.client->start();
    bus.client->publish(make_message("asip/lamp", "on", 1));
    ASSERT_TRUE(until(bus, [&] { return !bus.published.empty(); }));
    EXPECT_THAT(broker.published_qos, ElementsAre(1, 0)) << "sent again";
    ASSERT_EQ(bus.connects.size(), 2U);
    EXPECT_THAT(broker.identifier("asip-lamp"), testing::MatchesRegex("asip-lamp-[0-9a-f]{16}-[0-9a-f]{4}"));
    constexpr char kWillQos = 0x18, kFlags = 9;
    EXPECT_EQ(broker.connect_packet[kFlags] & kWillQos, 0);
    bus.client->subscribe("in", {.qos = 1});
    ASSERT_TRUE(until(bus, [&] { return bus.client->subscribed(); }));
    EXPECT_THAT(broker.subscribed_qos, ElementsAre(0));
}

TEST_F(SubscriptionTest, RefusedAfterLong_AsksTheNextBrokerForQos0) {
    ScriptedBroker next;
    broker.store_nothing(3500ms);
    auto both = options();
    both.version = mqtt::Version::kV311;
    both.brokers.push_back({"127.0.0.1", next.port(), false});
    Recorder bus(both);
    bus.client->subscribe("in", {.qos = 1});
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] {
        next.run();
        return bus.client->subscribed();
    }));
    EXPECT_THAT(broker.subscribed_qos, ElementsAre(1));
    EXPECT_THAT(next.subscribed_qos, ElementsAre(0));
}

TEST_F(SubscriptionTest, Qos0AsAnOption_IsUsedForAll) {
    auto made = options();
    made.qos = 0;
    Recorder bus(made);
    bus.client->subscribe("in", {.qos = 1});
    bus.client->start();
    bus.client->publish(make_message("asip/lamp", "on", 1));
    ASSERT_TRUE(until(bus, [&] { return bus.client->subscribed() && !bus.published.empty(); }));
    EXPECT_THAT(bus.published, ElementsAre("asip/lamp")) << "handed over";
    EXPECT_THAT(broker.subscribed_qos, ElementsAre(0));
    EXPECT_THAT(broker.published_qos, ElementsAre(0));
}

TEST_F(SubscriptionTest, RequiredAndRefusedThreeTimes_TriesTheNextBroker) {
    MosquittoBroker next;
    broker.refuse_subscriptions(1000);
    auto both = options();
    both.brokers.push_back(*mqtt::parse_broker(next.url()));
    Recorder bus(both);
    bus.client->subscribe("in", {.qos = 1, .required = true});
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return bus.client->subscribed(); }));
    EXPECT_EQ(broker.subscriptions, 3);
    ASSERT_EQ(bus.losses.size(), 1u);
    EXPECT_EQ(bus.losses[0].kind, Kind::kRefused);
    EXPECT_THAT(bus.losses[0].text, testing::HasSubstr("refuses the subscription to in"));
    EXPECT_EQ(bus.connects.back().broker.port, next.port());
}

TEST_F(SubscriptionTest, AnswerToASubscriptionTakesLongerThanAckTimeout_KeepsTheConnection) {
    broker.answer_nothing_after_connect();
    auto patient = options();
    patient.ack_timeout = 1s;
    patient.subscribe_timeout = 20s;
    Recorder bus(patient);
    bus.client->subscribe("in", {.qos = 1});
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return bus.client->connected() && broker.subscriptions == 1; }));
    bus.client->publish(make_message("state", "online", 1));
    until(bus, [&] { return !bus.losses.empty(); }, 3500ms);
    EXPECT_TRUE(bus.losses.empty()) << bus.losses[0].text;
    broker.answer_all();
    ASSERT_TRUE(until(bus, [&] { return bus.client->subscribed() && !bus.published.empty(); }));
}

TEST_F(SubscriptionTest, RetainedMessagesTakeLongerThanAckTimeout_KeepTheConnection) {
    auto patient = options();
    patient.ack_timeout = 1s;
    Recorder bus(patient);
    bus.client->subscribe("t", {.qos = 0});
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return bus.client->subscribed(); }));
    broker.answer_nothing_after_connect();
    bus.client->publish(make_message("state", "online", 1));
    const auto lost_while = [&](bool retained) {
        return until(
            bus,
            [&] {
                broker.deliver(retained);
                return !bus.losses.empty();
            },
            3500ms);
    };
    EXPECT_FALSE(lost_while(true)) << bus.losses[0].text;
    EXPECT_TRUE(lost_while(false)) << "what others publish says nothing about acknowledgements";
}

TEST_F(SubscriptionTest, SubscriptionNeverAnswered_IsStalledAfterItsOwnTime) {
    broker.answer_nothing_after_connect();
    auto patient = options();
    patient.ack_timeout = 1s;
    patient.subscribe_timeout = 2s;
    Recorder bus(patient);
    bus.client->subscribe("in", {.qos = 1});
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return !bus.losses.empty(); }));
    EXPECT_EQ(bus.losses[0].kind, Kind::kStalled);
    EXPECT_THAT(bus.losses[0].text, testing::HasSubstr("does not answer a subscription"));
}

TEST_F(SubscriptionTest, Connect_SaysHowLargeAPacketMayBe) {
    auto bounded = options();
    bounded.max_packet_bytes = 0x00012345;
    Recorder bus(bounded);
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return bus.client->connected(); }));
    EXPECT_THAT(broker.connect_packet, testing::HasSubstr(std::string("\x27\x00\x01\x23\x45", 5)));
}

TEST(PacketLimit, LargerMessage_IsNotDeliveredAndTheNextOneIs) {
    MosquittoBroker broker;
    auto options = options_for(broker);
    options.max_packet_bytes = 4096;
    Recorder bus(options);
    bus.client->subscribe("in", {.qos = 1});
    ASSERT_TRUE(bus.connect());
    Recorder sender(options_for(broker));
    ASSERT_TRUE(sender.connect());
    sender.client->publish(make_message("in", std::string(1 << 20, 'x'), 1));
    sender.client->publish(make_message("in", "small", 1));
    ASSERT_TRUE(sender.until([&] { return sender.published.size() == 2; }));
    ASSERT_TRUE(bus.received("in", "small"));
    EXPECT_EQ(bus.messages.size(), 1u);
    EXPECT_TRUE(bus.losses.empty());
}

// The acknowledgement and the message are two small packets, of which the broker keeps back the second.
TEST(Client, BrokerWithNaglesAlgorithm_IsAcknowledgedAtOnce) {
    MosquittoBroker broker({.extra_lines = {"set_tcp_nodelay false"}});
    Recorder bus(options_for(broker));
    bus.client->subscribe("echo");
    ASSERT_TRUE(bus.connect());
    ASSERT_TRUE(bus.until([&] { return bus.client->subscribed(); }));
    Duration quickest = 1h;
    for (std::size_t i = 1; i <= 20; ++i) {
        const auto begin = Clock::now();
        bus.client->publish(make_message("echo", "x", 1));
        ASSERT_TRUE(bus.until([&] { return bus.messages.size() == i && bus.published.size() == i; }));
        if (i > 5) quickest = std::min<Duration>(quickest, Clock::now() - begin);
    }
    EXPECT_LT(quickest, 20ms);
}

}  // namespace
}  // namespace asip::test
