// SPDX-License-Identifier: Apache-2.0
// A broker whose host receives nothing any more.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/integration/mqtt/recorder.hpp"
#include "tests/integration/mqtt/scripted_broker.hpp"

namespace asip::test {
namespace {

using Kind = mqtt::ConnectionFailure::Kind;

TEST(ClientCutOff, HostAcknowledgesNothing_NextBrokerIsTriedLongBeforeTheKeepAlive) {
    ScriptedBroker cut_off, other;
    mqtt::Options options;
    options.brokers = {{"127.0.0.1", cut_off.port(), false}, {"127.0.0.1", other.port(), false}};
    options.keepalive = std::chrono::hours(1);
    options.unreceived_timeout = 1s;
    Recorder bus(options);
    const auto until = [&](auto condition) {
        return bus.until([&] { return cut_off.run(), other.run(), condition(); });
    };
    bus.client->subscribe("t");
    bus.client->start();
    ASSERT_TRUE(until([&] { return bus.client->subscribed(); }));
    cut_off.cut_off_subscriber();
    bus.client->publish({.topic = "of no use", .payload = "."});
    ASSERT_TRUE(until([&] { return !bus.losses.empty() && bus.client->subscribed(); }));
    EXPECT_EQ(bus.losses[0].kind, Kind::kStalled);
    EXPECT_EQ(bus.losses[0].broker.port, cut_off.port());
    EXPECT_EQ(bus.connects.back().broker.port, other.port());
}

}  // namespace
}  // namespace asip::test
