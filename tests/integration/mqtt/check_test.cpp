// SPDX-License-Identifier: Apache-2.0
// Client::check: what its answer proves, and what it leaves alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/integration/mqtt/recorder.hpp"
#include "tests/integration/mqtt/scripted_broker.hpp"
#include "tests/support/bus_probe.hpp"

namespace asip::test {
namespace {

class ClientCheckVersions : public testing::TestWithParam<mqtt::Version> {};

TEST_P(ClientCheckVersions, Answered_BehindWhatTheBrokerWroteBefore) {
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
    EXPECT_FALSE(bus.client->check([] { FAIL() << "one at a time"; }));
    ASSERT_TRUE(bus.until([&] { return before.has_value(); }));
    EXPECT_EQ(*before, 10u);
    bool again = false;
    ASSERT_TRUE(bus.client->check([&] { again = true; }));
    EXPECT_TRUE(bus.until([&] { return again; }));
    EXPECT_TRUE(bus.client->subscribed()) << "it is about no subscription";
    EXPECT_EQ(bus.subscribed_calls, 1);
}

INSTANTIATE_TEST_SUITE_P(Versions, ClientCheckVersions,
                         testing::Values(mqtt::Version::kV5, mqtt::Version::kV311), [](const auto& version) {
                             return version.param == mqtt::Version::kV5 ? std::string("V5")
                                                                        : std::string("V311");
                         });

TEST(ClientCheck, NotConnected_IsNotSent) {
    MosquittoBroker broker;
    Recorder bus(options_for(broker));
    EXPECT_FALSE(bus.client->check([] { FAIL(); }));
}

TEST(ClientCheck, UnsubscribedMeanwhile_ThatAnswerIsNotTakenForIt) {
    MosquittoBroker broker;
    BusProbe probe(broker.port(), {});
    Recorder bus(options_for(broker));
    bus.client->subscribe("in");
    ASSERT_TRUE(bus.connect());
    ASSERT_TRUE(bus.until([&] { return bus.client->subscribed(); }));
    broker.freeze();
    bus.client->unsubscribe("in");
    int answers = 0;
    ASSERT_TRUE(bus.client->check([&] { ++answers; }));
    broker.thaw();
    ASSERT_TRUE(bus.until([&] { return answers > 0; }));
    bool again = false;
    ASSERT_TRUE(bus.client->check([&] { again = true; }));
    ASSERT_TRUE(bus.until([&] { return again; }));
    EXPECT_EQ(answers, 1);
}

TEST(ClientCheck, NoAnswer_LeavesTheConnectionAlone) {
    ScriptedBroker broker;
    mqtt::Options options;
    options.brokers = {{"127.0.0.1", broker.port(), false}};
    options.ack_timeout = 1s;
    options.subscribe_timeout = 1s;
    Recorder bus(options);
    bus.client->start();
    const auto both = [&](auto condition, std::chrono::milliseconds limit = kDeadline) {
        return bus.until([&] { return broker.run(), condition(); }, limit);
    };
    ASSERT_TRUE(both([&] { return bus.client->connected(); }));
    ASSERT_TRUE(bus.client->check([] { FAIL(); }));
    EXPECT_FALSE(both([&] { return !bus.losses.empty(); }, 4s));
}

TEST(ClientCheck, ConnectionLostBeforeTheAnswer_NextConnectionIsCheckedAnew) {
    MosquittoBroker broker;
    Recorder bus(options_for(broker));
    ASSERT_TRUE(bus.connect());
    broker.freeze();
    int earlier = 0;
    ASSERT_TRUE(bus.client->check([&] { ++earlier; }));
    broker.kill();
    ASSERT_TRUE(bus.until([&] { return bus.losses.size() == 1; }));
    broker.start();
    ASSERT_TRUE(bus.until([&] { return bus.client->connected(); }));
    bool answered = false;
    ASSERT_TRUE(bus.client->check([&] { answered = true; }));
    EXPECT_TRUE(bus.until([&] { return answered; }));
    EXPECT_EQ(earlier, 0);
}

}  // namespace
}  // namespace asip::test
