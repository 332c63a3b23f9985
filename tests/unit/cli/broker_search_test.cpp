// SPDX-License-Identifier: Apache-2.0
// What announcements of brokers say, and what no announcement may do.
#include "cli/find/broker_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace asip::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Packet = std::vector<std::uint8_t>;

/// An answer of Avahi 0.8 to broker_question(0x1234).
constexpr std::string_view kAnswer =
    "123484000001000500000000055f6d717474045f746370056c6f63616c00000c0001c00c000c00010000000a00141142"
    "726f6b6572206f6620746865206c6162c00cc02e001000010000000a000100c02e002100010000000a000b0000000007"
    "6b027069c017c061001c00010000000a001000000000000000000000000000000001c061000100010000000a00040a09"
    "0801";

Packet answer() {
    Packet packet;
    for (std::size_t i = 0; i < kAnswer.size(); i += 2)
        packet.push_back(
            static_cast<std::uint8_t>(std::stoul(std::string(kAnswer.substr(i, 2)), nullptr, 16)));
    return packet;
}

TEST(BrokerSearch, AnAnswer_NamesBrokerAddressAndPort) {
    EXPECT_THAT(announced_brokers(answer(), 0x1234, "10.0.0.9"),
                ElementsAre(AnnouncedBroker{"Broker of the lab", {"10.9.8.1", 1899, false}}));
}

TEST(BrokerSearch, WithoutAnAddress_TheSenderIsMeant) {
    auto packet = answer();
    packet[packet.size() - 13] = 16;  // the address record becomes a text
    EXPECT_THAT(announced_brokers(packet, 0x1234, "10.0.0.9"),
                ElementsAre(AnnouncedBroker{"Broker of the lab", {"10.0.0.9", 1899, false}}));
}

TEST(BrokerSearch, WhatWasNotAsked_IsNoAnswer) {
    EXPECT_THAT(announced_brokers(answer(), 0x1235, "10.0.0.9"), IsEmpty());
    EXPECT_THAT(announced_brokers(broker_question(0x1234), 0x1234, "10.0.0.9"), IsEmpty());
    EXPECT_THAT(announced_brokers({}, 0x1234, "10.0.0.9"), IsEmpty());
}

TEST(BrokerSearch, CutOrDamagedPackets_HarmNothing) {
    const auto whole = answer();
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_LE(announced_brokers({whole.data(), size}, 0x1234, "10.0.0.9").size(), 1U);
    for (std::size_t at = 0; at < whole.size(); ++at) {
        for (unsigned bit = 0; bit < 8; ++bit) {
            auto packet = whole;
            packet[at] = static_cast<std::uint8_t>(packet[at] ^ (1U << bit));
            EXPECT_LE(announced_brokers(packet, 0x1234, "10.0.0.9").size(), 1U);
        }
    }
}

TEST(BrokerSearch, TheQuestion_IsAsTheStandardWantsIt) {
    const auto packet = broker_question(0xabcd);
    EXPECT_EQ(std::string(packet.begin() + 12, packet.end()),
              std::string("\5_mqtt\4_tcp\5local\0\0\x0c\0\1", 22));
    EXPECT_EQ(packet[0], 0xab);
    EXPECT_EQ(packet[1], 0xcd);
}

}  // namespace
}  // namespace asip::cli
