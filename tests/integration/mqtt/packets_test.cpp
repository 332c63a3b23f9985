// SPDX-License-Identifier: Apache-2.0
// What travels in which packet, and when.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/integration/mqtt/recorder.hpp"
#include "tests/integration/mqtt/scripted_broker.hpp"
#include "tests/support/bus_probe.hpp"

namespace asip::test {
namespace {

class Packets : public testing::Test {
  protected:
    mqtt::Options options() {
        mqtt::Options made;
        made.brokers = {{"127.0.0.1", broker.port(), false}};
        return made;
    }
    template <class Condition>
    bool until(Recorder& bus, Condition condition) {
        return bus.until([&] { return broker.run(), condition(); });
    }

    ScriptedBroker broker;
};

TEST_F(Packets, MessageOfQos1_IsHandedOutBeforeItIsAcknowledged) {
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

TEST_F(Packets, Connect_SaysHowLargeAPacketMayBe) {
    auto bounded = options();
    bounded.max_packet_bytes = 0x00012345;
    Recorder bus(bounded);
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return bus.client->connected(); }));
    EXPECT_THAT(broker.connect_packet, testing::HasSubstr(std::string("\x27\x00\x01\x23\x45", 5)));
}

TEST_F(Packets, Connect_SaysHowManyMessagesMayBeUnderWay) {
    Recorder bus(options());
    bus.client->start();
    ASSERT_TRUE(until(bus, [&] { return bus.client->connected(); }));
    EXPECT_THAT(broker.connect_packet, testing::HasSubstr(std::string("\x21\x00\xc8", 3)));
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
