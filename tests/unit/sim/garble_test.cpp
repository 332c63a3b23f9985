// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/garble.hpp"

#include <gtest/gtest.h>

namespace asip::sim {
namespace {

TEST(RatesMatch, WithinThreePercent_Match) {
    EXPECT_TRUE(rates_match(100, 100));
    EXPECT_TRUE(rates_match(102.9, 100));
    EXPECT_TRUE(rates_match(97.1, 100));
    EXPECT_FALSE(rates_match(104, 100));
    EXPECT_FALSE(rates_match(96, 100));
}

TEST(Hear, SameRate_EveryByteIsHeardAsItIs) {
    for (int byte = 0; byte < 256; ++byte) {
        const auto received = receive_frame(static_cast<std::uint8_t>(byte), 10, 10);
        ASSERT_EQ(received.size(), 1u) << byte;
        EXPECT_EQ(received[0].byte, byte);
        EXPECT_FALSE(received[0].framing_error);
    }
}

TEST(Hear, SlightlyOffRate_EveryByteIsStillHeard) {
    for (int byte = 0; byte < 256; ++byte)
        for (const double receiver : {9.6, 10.4}) {
            const auto received = receive_frame(static_cast<std::uint8_t>(byte), 10, receiver);
            ASSERT_EQ(received.size(), 1u);
            EXPECT_EQ(received[0].byte, byte);
        }
}

TEST(Hear, ReceiverTwiceAsFast_HearsTwoHalves) {
    // 0x55: low and high take turns, so the faster receiver finds a start bit again.
    EXPECT_GT(receive_frame(0x55, 20, 10).size(), 1u);
}

TEST(Hear, ZeroAtHalfTheReceiversRate_HasNoStopBit) {
    const auto received = receive_frame(0x00, 20, 10);
    ASSERT_FALSE(received.empty());
    EXPECT_EQ(received[0].byte, 0);
    EXPECT_TRUE(received[0].framing_error);
}

TEST(Hear, ReceiverMuchSlower_HearsTheSilenceAfterwardsAsOnes) {
    const auto received = receive_frame(0x00, 10, 100);
    ASSERT_EQ(received.size(), 1u);
    EXPECT_EQ(received[0].byte, 0xff);
    EXPECT_FALSE(received[0].framing_error);
}

}  // namespace
}  // namespace asip::sim
