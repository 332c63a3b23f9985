// SPDX-License-Identifier: Apache-2.0
// Which broker a client connects to, when, and as whom.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/unit/mqtt/simulated_bus.hpp"

namespace asip::test {
namespace {

using Kind = mqtt::ConnectionFailure::Kind;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;

mqtt::Options named(const std::string& client_id) {
    mqtt::Options options;
    options.client_id = client_id;
    return options;
}

TEST(Connecting, BrokerThere_IsReportedWithVersion5) {
    SimulatedBus bus;
    EXPECT_FALSE(bus.core.connected());
    ASSERT_TRUE(bus.connect());
    EXPECT_TRUE(bus.core.v5());
    ASSERT_EQ(bus.connects.size(), 1u);
    EXPECT_EQ(bus.connects[0].broker.host, "broker0");
    EXPECT_THAT(bus.connects[0].client_id, MatchesRegex("asip-[0-9a-f]{12,}"));
    EXPECT_THAT(bus.failures, IsEmpty());
}

TEST(Connecting, NothingListens_IsReportedAndTriedOnWithAGrowingPause) {
    SimulatedBus bus;
    bus.brokers[0].refuses = Kind::kUnreachable;
    bus.start();
    bus.pass(1s);
    const auto first_second = bus.failures.size();
    EXPECT_GE(first_second, 3u);
    bus.pass(10s);
    EXPECT_LE(bus.failures.size() - first_second, 11u);
    EXPECT_EQ(bus.core.counters().failures, bus.failures.size());
    bus.brokers[0].refuses.reset();
    EXPECT_TRUE(bus.until([&] { return bus.core.connected(); }, 2s));
}

TEST(Connecting, BrokerThatHangs_IsGivenUpForTheNext) {
    SimulatedBus bus(2);
    bus.brokers[0].hangs = true;
    bus.start();
    bus.pass(6s);
    EXPECT_TRUE(bus.core.connected());
    EXPECT_EQ(bus.failures.at(0).kind, Kind::kNoAnswer);
}

TEST(Connecting, ConnectionCutOff_TheNextBrokerIsUsed) {
    SimulatedBus bus(2);
    ASSERT_TRUE(bus.connect());
    bus.pass(10s);
    bus.cut_off();
    bus.pass(1ms);
    ASSERT_TRUE(bus.core.connected());
    EXPECT_EQ(bus.losses.at(0).kind, Kind::kStalled);
    EXPECT_EQ(bus.connects.back().broker.host, "broker1");
}

TEST(Connecting, BrokersOfAList_SeeANewIdentifierOnEachConnection) {
    SimulatedBus bus(2, named("lamp"));
    ASSERT_TRUE(bus.connect());
    for (int i = 0; i < 3; ++i) {
        bus.pass(10s);
        i == 0 ? bus.cut_off() : bus.close();
        ASSERT_TRUE(bus.until([&] { return bus.core.connected(); }));
        EXPECT_EQ(bus.connects.back().client_id, "lamp") << "the program sees the name";
    }
    std::set<std::string> seen;
    for (const auto& broker : bus.brokers)
        for (const auto& attempt : broker.attempts)
            seen.insert(attempt.client_id);
    EXPECT_THAT(seen, ElementsAre("lamp-s1", "lamp-s2", "lamp-s3", "lamp-s4"));
}

TEST(Connecting, OneBroker_SeesTheSameIdentifierAlways) {
    SimulatedBus bus(1, named("lamp"));
    ASSERT_TRUE(bus.connect());
    bus.close();
    ASSERT_TRUE(bus.until([&] { return bus.core.connected(); }));
    EXPECT_EQ(bus.broker().attempts.back().client_id, "lamp-s1");
}

TEST(Connecting, NewIdentifierIsRefused_TheFirstOneIsUsedAgain) {
    SimulatedBus bus(2, named("lamp"));
    for (auto& broker : bus.brokers)
        broker.only_client_id = "lamp-s1";
    ASSERT_TRUE(bus.connect());
    bus.close();
    ASSERT_TRUE(bus.until([&] { return bus.core.connected(); }));
    EXPECT_EQ(bus.broker().attempts.back().client_id, "lamp-s1");
    EXPECT_EQ(bus.failures.size(), 1u);
}

TEST(Connecting, WrongPassword_IsHopelessUntilOnceAccepted) {
    SimulatedBus bus;
    bus.brokers[0].refuses = Kind::kBadCredentials;
    bus.start();
    EXPECT_TRUE(bus.failures.at(0).fatal());
    EXPECT_TRUE(bus.failures.at(0).hopeless);
    bus.brokers[0].refuses.reset();
    ASSERT_TRUE(bus.until([&] { return bus.core.connected(); })) << "it is tried on all the same";
    bus.brokers[0].refuses = Kind::kBadCredentials;
    bus.close();
    ASSERT_TRUE(bus.until([&] { return bus.failures.size() > 2; }));
    EXPECT_FALSE(bus.failures.back().hopeless);
}

TEST(Connecting, ClosedRightAfterAMessageAgainAndAgain_SaysThatRulesMayDenyIt) {
    SimulatedBus bus;
    bus.brokers[0].closes_publishers = true;
    bus.at_connect = [&] { bus.publish("asip/lamp", "on"); };
    bus.start();
    ASSERT_TRUE(bus.until([&] { return bus.losses.size() == 3; }));
    EXPECT_EQ(bus.losses[2].after_sending, 3u);
    EXPECT_THAT(bus.losses[2].text, HasSubstr("access rules"));
}

TEST(Connecting, ProgramAsksForALaterAttempt_ItIsThen) {
    SimulatedBus bus;
    bus.brokers[0].refuses = Kind::kBadCredentials;
    bus.start();
    bus.core.retry_in(30s, bus.now);
    bus.pass(29s);
    EXPECT_EQ(bus.broker().attempts.size(), 1u);
    bus.pass(2s);
    EXPECT_GE(bus.broker().attempts.size(), 2u);
}

TEST(Connecting, WillSetMeanwhile_IsThatOfTheNextConnection) {
    SimulatedBus bus;
    ASSERT_TRUE(bus.connect());
    EXPECT_FALSE(bus.brokers[0].attempts.at(0).will);
    bus.core.set_will({.topic = "state", .payload = "lost", .qos = 1});
    bus.close();
    ASSERT_TRUE(bus.until([&] { return bus.core.connected(); }));
    ASSERT_TRUE(bus.brokers[0].attempts.back().will);
    EXPECT_EQ(bus.brokers[0].attempts.back().will->payload, "lost");
}

TEST(Connecting, WhatOnConnectedPublishes_IsHeardByTheOwnSubscription) {
    SimulatedBus bus;
    bus.subscribe("echo");
    bus.at_connect = [&] {
        EXPECT_EQ(bus.broker().subscriptions.size(), 1u);
        bus.publish("echo", "first");
    };
    ASSERT_TRUE(bus.connect());
    EXPECT_EQ(bus.broker().published.size(), 1u);
}

TEST(Connecting, WhatOnConnectedDiscards_IsNotSent) {
    SimulatedBus bus;
    bus.publish({.topic = "state", .payload = "old"}, mqtt::Priority::kAnnouncement);
    bus.at_connect = [&] {
        bus.core.discard_queued(mqtt::Priority::kAnnouncement);
        bus.publish({.topic = "state", .payload = "new"}, mqtt::Priority::kAnnouncement);
    };
    ASSERT_TRUE(bus.connect());
    ASSERT_EQ(bus.broker().published.size(), 1u);
    EXPECT_EQ(bus.broker().published[0].payload, "new");
}

}  // namespace
}  // namespace asip::test
