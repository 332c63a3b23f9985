// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/integration/mqtt/recorder.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/patterns.hpp"

namespace asip::test {
namespace {

using mqtt::ConnectionFailure;
using mqtt::Priority;
using Kind = ConnectionFailure::Kind;

TEST(Client, BrokerWithoutQos1_IsUsedWithQos0) {
    MosquittoBroker broker({.extra_lines = {"max_qos 0"}});
    BusProbe probe(broker.port());
    auto options = options_for(broker);
    options.will = make_message("asip/lamp/state", "lost", 1);
    Recorder bus(options);
    bus.client->publish(make_message("out", "on", 1));
    ASSERT_TRUE(bus.connect());
    EXPECT_TRUE(bus.failures.empty());
    EXPECT_TRUE(bus.until([&] { return probe.count("out") == 1 && !bus.published.empty(); }));
    EXPECT_THAT(bus.published, testing::ElementsAre("out"));
}

TEST(Client, UserPropertiesThatNobodyKnows_AreDroppedWhenRead) {
    MosquittoBroker broker;
    Recorder bus(options_for(broker));
    bus.client->subscribe("in");
    ASSERT_TRUE(bus.connect());
    auto message = make_message("in", "on");
    for (int i = 0; i < 1000; ++i)
        message.user_properties.emplace_back("junk", std::string(100, 'x'));
    message.user_properties.emplace_back("by", "ann");
    message.user_properties.emplace_back("by", "bob");
    message.user_properties.emplace_back("clock", std::string(300, 'x'));
    message.user_properties.emplace_back("clock", "1f3c09aa-1");
    bus.client->publish(message);
    ASSERT_TRUE(bus.received("in", "on"));
    EXPECT_THAT(bus.messages[0].user_properties,
                testing::ElementsAre(testing::Pair("by", "ann"), testing::Pair("clock", "1f3c09aa-1")));
    EXPECT_LT(bus.messages[0].bytes(), 300u);
}

TEST(Client, PropertiesOnVersion5_ArriveAndReturn) {
    MosquittoBroker broker;
    BusProbe probe(broker.port());
    Recorder bus(options_for(broker));
    bus.client->subscribe("in");
    ASSERT_TRUE(bus.connect());
    auto message = make_message("out", std::string("zero\0inside", 11), 1);
    message.response_topic = "answer/here";
    message.correlation = std::string("\0\xff", 2);
    message.expiry_seconds = 60;
    bus.client->publish(message);
    ASSERT_TRUE(bus.until([&] { return probe.count("out") == 1; }));
    const auto arrived = probe.messages("out").at(0);
    EXPECT_EQ(arrived.payload, message.payload);
    EXPECT_EQ(arrived.response_topic, "answer/here");
    EXPECT_EQ(arrived.correlation, message.correlation);
    EXPECT_TRUE(arrived.expiry_seconds.has_value());
    message.topic = "in";
    probe.publish(message);
    ASSERT_TRUE(bus.until([&] { return !bus.messages.empty(); }));
    EXPECT_EQ(bus.messages[0].response_topic, "answer/here");
    EXPECT_EQ(bus.messages[0].correlation, message.correlation);
    EXPECT_THAT(bus.published, testing::ElementsAre("out"));
}

TEST(Client, GathersMessages_WhatFollowsARead_WaitsForTheNextOne) {
    constexpr auto kGather = std::chrono::milliseconds(100);
    MosquittoBroker broker;
    BusProbe probe(broker.port(), {});
    auto options = options_for(broker);
    options.gather = kGather;
    Recorder bus(options);
    bus.client->subscribe("t");
    ASSERT_TRUE(bus.connect());
    ASSERT_TRUE(bus.until([&] { return bus.client->subscribed(); }));
    const auto began = Clock::now();
    for (int i = 0; i < 6; ++i) {
        probe.publish("t", std::to_string(i));
        ASSERT_TRUE(bus.received("t", std::to_string(i))) << i;
    }
    EXPECT_GE(Clock::now() - began, 5 * kGather) << "six reads";
}

TEST(Client, NoLocal_DoesNotHearItself) {
    MosquittoBroker broker;
    BusProbe probe(broker.port(), {});
    Recorder bus(options_for(broker));
    bus.client->subscribe("t", {.qos = 1, .no_local = true, .retained = true});
    ASSERT_TRUE(bus.connect());
    bus.client->publish(make_message("t", "own", 1));
    ASSERT_TRUE(bus.until([&] { return bus.published.size() == 1; }));
    probe.publish("t", "other");
    ASSERT_TRUE(bus.received("t", "other"));
    EXPECT_EQ(bus.messages.size(), 1u);
}

TEST(Client, RetainedNotWanted_IsNotDeliveredOnVersion5AndMarkedOn311) {
    MosquittoBroker broker;
    BusProbe probe(broker.port());
    probe.publish("t", "old", true);
    ASSERT_TRUE(probe.wait_for("t", "old"));
    const auto first_heard = [&](mqtt::Version version) {
        auto options = options_for(broker);
        options.version = version;
        Recorder bus(options);
        bus.client->subscribe("t", {.qos = 1, .no_local = false, .retained = false});
        EXPECT_TRUE(bus.connect());
        bus.client->publish(make_message("t", "new", 1));
        EXPECT_TRUE(bus.received("t", "new"));
        return bus.messages.at(0);
    };
    EXPECT_EQ(first_heard(mqtt::Version::kV5).payload, "new");
    const auto replayed = first_heard(mqtt::Version::kV311);
    EXPECT_EQ(replayed.payload, "old");
    EXPECT_TRUE(replayed.retain);
}

TEST(Client, Destroyed_BrokerPublishesTheWill) {
    MosquittoBroker broker;
    BusProbe probe(broker.port());
    auto options = options_for(broker);
    options.will = make_message("asip/servicebus/uno1/$state", "lost", 1, true);
    {
        Recorder bus(options);
        ASSERT_TRUE(bus.connect());
    }
    EXPECT_TRUE(probe.wait_for("asip/servicebus/uno1/$state", "lost"));
}

TEST(Client, Stopped_SendsWhatIsQueuedAndNoWill) {
    MosquittoBroker broker;
    BusProbe probe(broker.port());
    auto options = options_for(broker);
    options.will = make_message("state", "lost", 1);
    Recorder bus(options);
    ASSERT_TRUE(bus.connect());
    for (int i = 0; i < 500; ++i)
        bus.client->publish(make_message("n", std::to_string(i), i % 2));
    bus.client->publish(make_message("state", "offline", 1), Priority::kAnnouncement);
    bool stopped = false;
    bus.client->stop(5s, [&] { stopped = true; });
    ASSERT_TRUE(bus.until([&] { return stopped; }));
    EXPECT_TRUE(probe.wait_for("state", "offline"));
    EXPECT_EQ(probe.count("n"), 500u);
    EXPECT_TRUE(wait_until([&] { return broker.log().find("disconnected.") != std::string::npos; }));
    EXPECT_EQ(probe.last("state"), "offline");
}

TEST(Client, BrokerKilledAndBack_ReconnectsSubscribesAndLosesNoQos1) {
    MosquittoBroker broker;
    Recorder bus(options_for(broker));
    bus.client->subscribe("commands");
    ASSERT_TRUE(bus.connect());
    broker.kill();
    ASSERT_TRUE(bus.until([&] { return !bus.losses.empty(); }));
    EXPECT_EQ(bus.losses[0].kind, Kind::kClosed);
    for (int i = 0; i < 100; ++i)
        bus.client->publish(make_message("kept", std::to_string(i), 1), Priority::kReply);
    broker.start();
    BusProbe probe(broker.port());
    ASSERT_TRUE(bus.until([&] { return bus.client->connected(); }, time_limit(4s)));
    EXPECT_TRUE(bus.until([&] { return probe.count("kept") == 100; }));
    probe.publish("commands", "again");
    EXPECT_TRUE(bus.received("commands", "again"));
    EXPECT_TRUE(bus.client->v5());
}

std::string identifier_of(const std::string& name, const MosquittoBroker& broker) {
    const auto found = test::first_match(broker.log(), " as (" + name + "-[0-9a-f]{16}[-0-9a-f]*) ");
    return found ? found->at(1) : std::string();
}

TEST(Client, NameThatIsPublished_IsNotTheIdentifierThatTheBrokerKnows) {
    MosquittoBroker broker;
    auto options = options_for(broker);
    options.client_id = "lamp";
    Recorder bus(options);
    ASSERT_TRUE(bus.connect());
    EXPECT_EQ(bus.connects[0].client_id, "lamp");
    BusProbe::Options other;
    other.client_id = bus.client->client_id();
    BusProbe probe(broker.port(), {"x"}, other);
    bus.client->publish(make_message("x", "still here", 1));
    EXPECT_TRUE(bus.until([&] { return probe.count("x") == 1; }));
    EXPECT_TRUE(bus.losses.empty());
    const auto before = identifier_of("lamp", broker);
    Recorder again(options);
    ASSERT_TRUE(again.connect());
    // The broker writes its log when it likes.
    EXPECT_TRUE(
        again.until([&] { return broker.log().rfind(" as lamp-") != broker.log().find(before) - 4; }));
    EXPECT_TRUE(bus.losses.empty());
}

TEST(Client, Password_LetsInOrIsFatalWithThatReason) {
    MosquittoBroker broker({.users = {{"ada", "right"}}});
    for (const auto version : {mqtt::Version::kBest, mqtt::Version::kV311}) {
        auto options = options_for(broker);
        options.user = "ada";
        options.password = "wrong";
        options.version = version;
        Recorder bus(options);
        bus.client->start();
        ASSERT_TRUE(bus.until([&] { return !bus.failures.empty(); }));
        EXPECT_EQ(bus.failures[0].kind, Kind::kBadCredentials);
        EXPECT_TRUE(bus.failures[0].fatal());
        EXPECT_THAT(bus.failures[0].text, testing::HasSubstr("ada"));
        options.password = "right";
        EXPECT_TRUE(Recorder(options).connect());
    }
}

class ClientVersions : public testing::TestWithParam<mqtt::Version> {};

TEST_P(ClientVersions, Check_IsAnsweredBehindWhatTheBrokerWroteBefore) {
    MosquittoBroker broker;
    BusProbe probe(broker.port(), {});
    auto options = options_for(broker);
    options.version = GetParam();
    Recorder bus(options);
    bus.client->subscribe("in", {.qos = 1});
    ASSERT_TRUE(bus.connect());
    ASSERT_TRUE(bus.until([&] { return bus.client->subscribed(); }));
    for (int i = 0; i < 10; ++i)
        probe.publish("in", std::to_string(i));
    ASSERT_TRUE(wait_until([&] { return probe.all_acknowledged(); }));
    std::optional<std::size_t> before;
    ASSERT_TRUE(bus.client->check([&] { before = bus.messages.size(); }));
    ASSERT_TRUE(bus.until([&] { return before.has_value(); }));
    EXPECT_EQ(*before, 10u);
    bool again = false;
    ASSERT_TRUE(bus.client->check([&] { again = true; }));
    EXPECT_TRUE(bus.until([&] { return again; }));
}

INSTANTIATE_TEST_SUITE_P(Both, ClientVersions, testing::Values(mqtt::Version::kV5, mqtt::Version::kV311),
                         [](const auto& version) {
                             return version.param == mqtt::Version::kV5 ? std::string("V5")
                                                                        : std::string("V311");
                         });

TEST(Client, DeniedPublish_IsReportedAndNeverRepeated) {
    TempDir folder;
    const auto rules = folder.write("acl", "topic readwrite good/#\ntopic read #\n");
    MosquittoBroker broker({.extra_lines = {"acl_file " + rules}});
    Recorder bus(options_for(broker));
    ASSERT_TRUE(bus.connect());
    bus.client->publish(make_message("denied/a", "", 1, true));
    bus.client->publish(make_message("denied/b", "x", 1));
    bus.client->publish(make_message("good/c", "x", 1));
    ASSERT_TRUE(bus.until([&] { return bus.published.size() == 1 && bus.denied.size() == 2; }));
    EXPECT_THAT(bus.denied, testing::ElementsAre("denied/a", "denied/b"));
    run_for(bus.io, 500ms);
    EXPECT_TRUE(bus.losses.empty()) << bus.losses[0].text;
    const auto log = broker.log();
    const auto first = log.find("Denied PUBLISH");
    EXPECT_EQ(log.find("denied/a", log.find("denied/a", first) + 1), std::string::npos) << log;
    EXPECT_EQ(bus.client->counters().rejected, 2u);
}

}  // namespace
}  // namespace asip::test
