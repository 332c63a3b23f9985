// SPDX-License-Identifier: Apache-2.0
// Brokers of a cluster that accept everything and deliver nothing.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/integration/mqtt/recorder.hpp"
#include "tests/integration/mqtt/scripted_broker.hpp"

namespace asip::test {
namespace {

class DeliveryTest : public testing::Test {
  protected:
    mqtt::Options options() {
        mqtt::Options made;
        made.brokers = {{"127.0.0.1", first.port(), false}, {"127.0.0.1", second.port(), false}};
        made.client_id = "lamp";
        made.own_topics = "self";
        made.check_delivery = 100ms;
        made.retry_first = 5ms;
        return made;
    }
    template <class Condition>
    bool until(Recorder& bus, Condition condition) {
        return until_beside(bus, condition, kDeadline, first, second);
    }

    ScriptedBroker first, second;
};

TEST_F(DeliveryTest, BrokerDeliversNothingAnyMore_TheNextIsUsed) {
    first.deliver_own(true);
    second.deliver_own(true);
    Recorder bus(options());
    bus.client->subscribe("lamp/in");
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return first.published_qos.size() >= 2; }));
    EXPECT_TRUE(bus.losses.empty());
    first.deliver_own(false);
    ASSERT_TRUE(until(bus, [&] { return second.published_qos.size() >= 2; }));
    ASSERT_EQ(bus.losses.size(), 1u);
    EXPECT_EQ(bus.losses[0].kind, mqtt::ConnectionFailure::Kind::kStalled);
    EXPECT_NE(bus.losses[0].text.find("does not deliver what is published any more"), std::string::npos);
    EXPECT_EQ(second.subscriptions, 2);
    EXPECT_TRUE(bus.messages.empty()) << "nobody is told of its own";
}

TEST_F(DeliveryTest, RulesDenyIt_OneConnectionIsLostForItAndNoMore) {
    first.close_publishers();
    second.close_publishers();
    Recorder bus(options());
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return bus.connects.size() == 2; }));
    run_for(bus.io, 2500ms);
    first.run();
    second.run();
    EXPECT_TRUE(bus.client->connected());
    EXPECT_EQ(bus.losses.size(), 1u);
    EXPECT_TRUE(second.published_qos.empty());
}

TEST_F(DeliveryTest, RulesDenyToReadIt_ThereIsNoCheck) {
    first.refuse_subscriptions(1);
    Recorder bus(options());
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return first.subscriptions == 1; })) << "when nothing else is waited for";
    run_for(bus.io, 2500ms);
    first.run();
    EXPECT_TRUE(bus.client->subscribed());
    EXPECT_TRUE(bus.losses.empty());
    EXPECT_TRUE(bus.refused_filters.empty()) << "nobody is told of its own";
    EXPECT_EQ(first.subscriptions, 1);
    EXPECT_TRUE(first.published_qos.empty());
}

TEST_F(DeliveryTest, AnotherSubscriptionIsRefused_DeliveryIsCheckedNevertheless) {
    first.deliver_own(true);
    first.refuse_filter("denied");
    Recorder bus(options());
    bus.client->subscribe("denied");
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return first.published_qos.size() >= 2; }));
    EXPECT_FALSE(bus.client->subscribed());
    first.deliver_own(false);
    EXPECT_TRUE(until(bus, [&] { return second.subscriptions > 0; }));
}

TEST_F(DeliveryTest, OwnSubscriptionHasNoAnswer_TheNextBrokerIsUsed) {
    auto made = options();
    made.subscribe_timeout = 1s;
    Recorder bus(made);
    bus.client->subscribe("lamp/in");
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return bus.client->subscribed(); }));
    first.answer_nothing_after_connect();
    ASSERT_TRUE(until(bus, [&] { return second.subscriptions > 0; }));
    EXPECT_EQ(first.subscriptions, 2);
    ASSERT_EQ(bus.losses.size(), 1u);
    EXPECT_NE(bus.losses[0].text.find("does not answer a subscription"), std::string::npos);
}

TEST_F(DeliveryTest, ClosedBeforeTheFirstAnswer_IsNotTakenForRulesThatDenyIt) {
    auto made = options();
    made.subscribe_timeout = 1s;
    Recorder bus(made);
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return first.published_qos.size() == 1; }));
    first.answer_nothing_after_connect();
    second.answer_nothing_after_connect();
    bus.client->subscribe("lamp/in");
    ASSERT_TRUE(until(bus, [&] { return second.subscriptions == 1; })) << "it has not come back yet";
    second.close_subscriber();
    for (auto* broker : {&first, &second}) {
        broker->deliver_own(true);
        broker->answer_all();
    }
    ASSERT_TRUE(until(bus, [&] { return first.published_qos.size() + second.published_qos.size() > 2; }));
}

/// The first broker delivers, and from now on acknowledges nothing.
struct UnacknowledgedTest : DeliveryTest {
    UnacknowledgedTest() {
        first.deliver_own(true);
        bus.client->subscribe("lamp/in");
        bus.client->start();
        EXPECT_TRUE(until(bus, [&] { return first.published_qos.size() >= 2; }));
        first.answer_nothing_after_connect();
    }
    static mqtt::Options impatient(mqtt::Options made) {
        made.ack_timeout = 1s;
        return made;
    }
    void run_beside(std::chrono::milliseconds time) {
        until_beside(bus, [] { return false; }, time, first, second);
    }
    void publish(int count) {
        for (int i = 0; i < count; ++i)
            bus.client->publish(make_message("asip/lamp", "on", 1));
    }
    std::ptrdiff_t with_qos_1() const {
        return std::count(first.published_qos.begin(), first.published_qos.end(), 1);
    }

    Recorder bus{impatient(options())};
};

TEST_F(UnacknowledgedTest, BrokerThatDelivers_IsUsedWithQos0UntilItAcknowledges) {
    publish(25);
    EXPECT_TRUE(until(bus, [&] { return bus.client->counters().queued == 0; }));
    EXPECT_EQ(with_qos_1(), 20);
    EXPECT_EQ(bus.client->counters().published, 5u);
    run_beside(3s);
    EXPECT_TRUE(bus.losses.empty());
    first.answer_all();
    EXPECT_TRUE(until(bus, [&] { return bus.client->counters().published == 25; }));
    run_beside(1500ms);
    publish(1);
    EXPECT_TRUE(until(bus, [&] { return bus.client->counters().published == 26; }));
    EXPECT_EQ(with_qos_1(), 21);
}

TEST_F(UnacknowledgedTest, BrokerBusyWithRetainedMessages_IsUsedWithQos0AllTheTime) {
    publish(20);
    EXPECT_TRUE(until(bus, [&] { return bus.client->counters().unacknowledged == 20; }));
    publish(1);
    EXPECT_TRUE(until(bus, [&] { return bus.client->counters().queued == 0; }));
    first.deliver(true);
    for (int i = 0; i < 4; ++i) {
        run_beside(500ms);
        publish(1);
        EXPECT_EQ(bus.client->counters().queued, 0u) << i;
    }
    EXPECT_EQ(with_qos_1(), 20);
}

TEST_F(UnacknowledgedTest, BrokerIsLostThen_WhatItTookIsNotSentAgainButWhatIsRetained) {
    publish(3);
    auto state = make_message("asip/lamp/state", "online", 1);
    state.retain = true;
    bus.client->publish(state);
    run_beside(3s);
    EXPECT_EQ(with_qos_1(), 4);
    EXPECT_TRUE(bus.published.empty());
    first.close_subscriber();
    EXPECT_TRUE(until(bus, [&] { return bus.published.size() == 3; }));
    first.answer_all();
    EXPECT_TRUE(until(bus, [&] { return bus.published.size() == 4; }));
    EXPECT_EQ(bus.published.back(), "asip/lamp/state");
    EXPECT_EQ(with_qos_1(), 5);
    EXPECT_EQ(bus.client->counters().published, 4u);
}

TEST_F(UnacknowledgedTest, StoppedWithAFullWindow_SendsWhatWaitsAndDisconnects) {
    publish(29);
    ASSERT_TRUE(until(bus, [&] { return with_qos_1() == 20; }));
    const auto before = first.published_qos.size();
    bool stopped = false;
    bus.client->stop(400ms, [&] { stopped = true; });
    EXPECT_TRUE(until(bus, [&] { return stopped && first.disconnects == 1; }));
    EXPECT_EQ(with_qos_1(), 20);
    EXPECT_GE(first.published_qos.size(), before + 9);
}

TEST_F(UnacknowledgedTest, RetainedOneWithANewerBehindIt_IsNotSentAgain) {
    const auto say = [&](const char* word) {
        auto state = make_message("asip/lamp/state", word, 1);
        state.retain = true;
        bus.client->publish(state);
    };
    say("old");
    run_beside(3s);
    say("new");
    EXPECT_EQ(with_qos_1(), 1);
    first.close_subscriber();
    EXPECT_TRUE(until(bus, [&] { return bus.connects.size() == 2; }));
    first.answer_all();
    publish(1);
    EXPECT_TRUE(until(bus, [&] { return bus.published.back() == "asip/lamp"; }));
    EXPECT_EQ(with_qos_1(), 2) << "the last one, and not the old one again";
}

TEST_F(UnacknowledgedTest, BrokerThatStopsToDeliver_IsLeft) {
    publish(1);
    run_beside(2s);
    EXPECT_TRUE(bus.losses.empty());
    first.deliver_own(false);
    EXPECT_TRUE(until(bus, [&] { return second.subscriptions > 0; }));
    EXPECT_EQ(bus.losses.size(), 1u);
}

}  // namespace
}  // namespace asip::test
