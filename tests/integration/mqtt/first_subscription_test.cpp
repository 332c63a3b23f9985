// SPDX-License-Identifier: Apache-2.0
// Two scripted brokers that accept connections and answer no subscription: whoever has left one asks the
// other for a single one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/integration/mqtt/recorder.hpp"
#include "tests/integration/mqtt/scripted_broker.hpp"

namespace asip::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class FirstSubscriptionTest : public testing::Test {
  protected:
    FirstSubscriptionTest() {
        first.answer_nothing_after_connect();
        second.answer_nothing_after_connect();
    }
    mqtt::Options options() {
        mqtt::Options made;
        made.brokers = {{"127.0.0.1", first.port(), false}, {"127.0.0.1", second.port(), false}};
        made.version = mqtt::Version::kV5;
        made.client_id = "lamp";
        made.subscribe_timeout = 2s;
        return made;
    }
    template <class Condition>
    bool until(Recorder& bus, Condition condition, std::chrono::milliseconds limit = kDeadline) {
        return until_beside(bus, condition, limit, first, second);
    }
    bool asked(Recorder& bus, int of_first, int of_second) {
        return until(bus,
                     [&] { return first.subscriptions == of_first && second.subscriptions == of_second; });
    }
    /// Subscribes to "a", "b" and "c", leaves the first broker, and has asked the second one for "a".
    bool asks_the_second(Recorder& bus) {
        for (const char* filter : {"a", "b", "c"})
            bus.client->subscribe(filter);
        bus.client->start();
        return asked(bus, 3, 1) && !bus.client->connected();
    }
    /// Subscribes to "a" and "b", leaves the first broker, which was cut off in between, and has asked the
    /// second one for so many of them.
    bool leaves_the_first_cut_off(Recorder& bus, int of_second) {
        bus.client->subscribe("a");
        bus.client->start();
        if (!asked(bus, 1, 0)) return false;
        first.cut_off_subscriber();
        bus.client->subscribe("b");
        return asked(bus, 1, of_second);
    }

    ScriptedBroker first, second;
};

TEST_F(FirstSubscriptionTest, Answered_TheRestIsAskedForAndConnectedReported) {
    Recorder bus(options());
    bus.at_connect = [&] { bus.client->publish(make_message("asip/lamp", "on")); };
    ASSERT_TRUE(asks_the_second(bus));
    EXPECT_EQ(bus.losses.size(), 1u);
    EXPECT_TRUE(second.published_qos.empty());
    EXPECT_EQ(bus.connects.size(), 1u) << "nobody is told of a connection before it is of use";
    second.answer_all();
    ASSERT_TRUE(until(bus, [&] { return bus.client->subscribed() && second.published_qos.size() == 1; }));
    EXPECT_EQ(second.subscriptions, 3);
    EXPECT_EQ(bus.connects.size(), 2u);
}

TEST_F(FirstSubscriptionTest, NotAnsweredEither_IsAFailedAttemptAndTheNextIsAskedForOne) {
    Recorder bus(options());
    ASSERT_TRUE(asks_the_second(bus));
    ASSERT_TRUE(asked(bus, 4, 1));
    EXPECT_EQ(bus.connects.size(), 1u);
    EXPECT_EQ(bus.losses.size(), 1u);
    ASSERT_EQ(bus.failures.size(), 1u);
    EXPECT_THAT(bus.failures[0].text, HasSubstr("does not answer a subscription"));
}

TEST_F(FirstSubscriptionTest, ClosedMeanwhile_TheNextIsAskedForOneByAnotherIdentifier) {
    Recorder bus(options());
    ASSERT_TRUE(asks_the_second(bus));
    const auto before = second.identifier("lamp");
    second.close_subscriber();
    ASSERT_TRUE(until(bus, [&] { return first.subscriptions + second.subscriptions > 4; }));
    EXPECT_FALSE(until(bus, [&] { return first.subscriptions + second.subscriptions > 5; }, 300ms));
    EXPECT_NE(first.identifier("lamp") + second.identifier("lamp"), before);
}

TEST_F(FirstSubscriptionTest, OtherIdentifierIsRefused_TheOwnOneIsUsedAgain) {
    second.let_in_only("lamp");
    auto alone = options();
    alone.brokers.erase(alone.brokers.begin());
    Recorder bus(alone);
    bus.client->subscribe("a");
    bus.client->start();
    ASSERT_TRUE(asked(bus, 0, 1));
    second.close_subscriber();
    ASSERT_TRUE(asked(bus, 0, 2));
    EXPECT_EQ(second.connects, 3);
    EXPECT_THAT(second.identifier("lamp"), testing::MatchesRegex("lamp-[0-9a-f]{16}"));
}

TEST_F(FirstSubscriptionTest, BrokerClosesWhoeverSubscribes_TheNextIsUsed) {
    first.close_subscribers();
    second.answer_all();
    Recorder bus(options());
    bus.client->subscribe("a");
    bus.client->start();
    EXPECT_TRUE(until(bus, [&] { return bus.client->subscribed(); }));
    EXPECT_EQ(first.subscriptions, 3);
    EXPECT_EQ(second.subscriptions, 1);
}

TEST_F(FirstSubscriptionTest, LeftBroker_SeesAnotherIdentifierNext) {
    Recorder bus(options());
    ASSERT_TRUE(asks_the_second(bus));
    EXPECT_THAT(first.connect_packet, HasSubstr("lamp"));
    EXPECT_EQ(second.identifier("lamp").find(first.identifier("lamp") + "-"), 0U);
}

int keepalive_in(const std::string& connect_packet) {
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(connect_packet.at(at)); };
    return byte(10) * 256 + byte(11);
}

TEST_F(FirstSubscriptionTest, LeftBroker_HasMoreTimeNext) {
    auto slow = options();
    slow.subscribe_timeout = 4s;
    slow.keepalive = 5s;
    Recorder bus(slow);
    ASSERT_TRUE(asks_the_second(bus));
    EXPECT_EQ(keepalive_in(first.connect_packet), 5);
    EXPECT_EQ(keepalive_in(second.connect_packet), 8);
    EXPECT_FALSE(until(bus, [&] { return !bus.failures.empty(); }, 7s));
    EXPECT_TRUE(until(bus, [&] { return !bus.failures.empty(); }));
}

TEST_F(FirstSubscriptionTest, OneBrokerAlone_HasNoMoreTimeThanOthers) {
    auto alone = options();
    alone.brokers.pop_back();
    alone.keepalive = 5s;
    alone.subscribe_timeout = 4s;
    Recorder bus(alone);
    for (const char* filter : {"a", "b", "c"})
        bus.client->subscribe(filter);
    bus.client->start();
    ASSERT_TRUE(asked(bus, 4, 0));
    EXPECT_EQ(keepalive_in(first.connect_packet), 5);
    EXPECT_TRUE(until(bus, [&] { return !bus.failures.empty(); }, 6s));
}

TEST_F(FirstSubscriptionTest, TimeOfMinutes_IsNotDoubled) {
    auto patient = options();
    patient.subscribe_timeout = 5min;
    Recorder bus(patient);
    ASSERT_TRUE(leaves_the_first_cut_off(bus, 1));
    EXPECT_EQ(keepalive_in(second.connect_packet), 60);
}

TEST_F(FirstSubscriptionTest, MessageBeforeTheAnswer_LeavesTheBrokerItsTime) {
    Recorder bus(options());
    ASSERT_TRUE(asks_the_second(bus));
    second.deliver(false);
    ASSERT_TRUE(until(bus, [&] { return bus.connects.size() == 2; }));
    EXPECT_FALSE(until(bus, [&] { return bus.losses.size() > 1; }, 3s));
    EXPECT_TRUE(bus.client->connected());
}

TEST_F(FirstSubscriptionTest, MessageBeforeTheAnswer_IsHandedOutBehindTheConnection) {
    Recorder bus(options());
    std::vector<std::size_t> connects;
    bus.at_message = [&](const mqtt::Message&) { connects.push_back(bus.connects.size()); };
    ASSERT_TRUE(asks_the_second(bus));
    second.deliver(false);
    ASSERT_TRUE(until(bus, [&] { return !connects.empty(); }));
    EXPECT_THAT(connects, ElementsAre(2u));
    EXPECT_TRUE(bus.client->connected());
}

TEST_F(FirstSubscriptionTest, UnsubscribedMeanwhile_TheBrokerIsTold) {
    Recorder bus(options());
    ASSERT_TRUE(asks_the_second(bus));
    bus.client->unsubscribe("a");
    ASSERT_TRUE(until(bus, [&] { return second.unsubscriptions == 1; }));
    second.answer_all();
    ASSERT_TRUE(until(bus, [&] { return bus.client->subscribed(); }));
    EXPECT_EQ(second.subscriptions, 3);
}

TEST_F(FirstSubscriptionTest, StoppedMeanwhile_SendsWhatIsQueuedAndGoodbye) {
    Recorder bus(options());
    ASSERT_TRUE(asks_the_second(bus));
    bus.client->publish(make_message("asip/lamp", "offline"));
    bool stopped = false;
    bus.client->stop(2s, [&] { stopped = true; });
    ASSERT_TRUE(until(bus, [&] { return stopped && second.disconnects == 1; }));
    EXPECT_EQ(second.published_qos.size(), 1u);
    EXPECT_EQ(second.subscriptions, 1);
}

TEST_F(FirstSubscriptionTest, StoppedLate_SaysGoodbye) {
    Recorder bus(options());
    ASSERT_TRUE(asks_the_second(bus));
    EXPECT_FALSE(until(bus, [&] { return !bus.failures.empty(); }, 3s));
    bool stopped = false;
    bus.client->stop(2s, [&] { stopped = true; });
    ASSERT_TRUE(until(bus, [&] { return stopped; }));
    EXPECT_EQ(second.disconnects, 1);
}

TEST_F(FirstSubscriptionTest, LeftToTheKeepAlive_EverythingIsAskedForAtOnce) {
    auto patient = options();
    patient.ack_timeout = 0s;
    patient.unreceived_timeout = 1s;
    Recorder bus(patient);
    ASSERT_TRUE(leaves_the_first_cut_off(bus, 2))
        << "an attempt that waits for the first answer would have no end";
}

}  // namespace
}  // namespace asip::test
