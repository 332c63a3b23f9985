// SPDX-License-Identifier: Apache-2.0
// Mosquitto whose limit is not below ours: it takes messages that it cannot deliver to us.
#include <gtest/gtest.h>

#include "tests/integration/mqtt/recorder.hpp"
#include "tests/support/bus_probe.hpp"

namespace asip::test {
namespace {

constexpr int kInFlight = 20;

class StandStillOfMosquitto : public testing::Test {
  protected:
    mqtt::Options options() const {
        auto made = options_for(broker);
        made.client_id = "lamp";
        made.max_packet_bytes = 3000;
        made.own_topics = "self";
        made.check_standstill = 1200ms;
        made.retry_first = 5ms;
        return made;
    }

    MosquittoBroker broker;
    BusProbe probe{broker.port(), {"none"}};
};

TEST_F(StandStillOfMosquitto, TooLargeMessagesTakeEachPlace_TheConnectionIsReplacedAndQos1ComesAgain) {
    Recorder bus(options());
    bus.client->subscribe("in", {.qos = 1});
    ASSERT_TRUE(bus.connect());
    ASSERT_TRUE(bus.until([&] { return bus.client->subscribed(); }));
    for (int i = 0; i < kInFlight; ++i)
        probe.publish("in", std::string(4000, 'x'));
    ASSERT_TRUE(bus.until([&] { return probe.all_acknowledged(); }));
    ASSERT_TRUE(bus.until([&] { return bus.connects.size() == 2; }));
    ASSERT_EQ(bus.losses.size(), 1U);
    EXPECT_EQ(bus.losses[0].kind, mqtt::ConnectionFailure::Kind::kStalled);
    EXPECT_NE(bus.losses[0].text.find("max_packet_size"), std::string::npos) << bus.losses[0].text;
    ASSERT_TRUE(bus.until([&] { return bus.client->subscribed(); }));
    probe.publish("in", "on");
    EXPECT_TRUE(bus.received("in", "on"));
    for (const auto& message : bus.messages)
        EXPECT_EQ(message.topic, "in") << "its own messages are for nobody else";
}

TEST_F(StandStillOfMosquitto, NothingStandsStill_TheConnectionStays) {
    Recorder bus(options());
    ASSERT_TRUE(bus.connect());
    BusProbe own(broker.port(), {"self/lamp/$qos1"});
    ASSERT_TRUE(bus.until([&] { return own.messages().size() >= 6; }));
    EXPECT_TRUE(bus.losses.empty());
    EXPECT_TRUE(bus.messages.empty());
}

}  // namespace
}  // namespace asip::test
