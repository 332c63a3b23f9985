// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/checksum.hpp"

#include <gtest/gtest.h>

namespace asip::protocol {
namespace {

TEST(Checksum, AppendedThenVerified_GivesTheLineBack) {
    EXPECT_EQ(append_checksum("I,d,13,1"), "I,d,13,1*32");
    EXPECT_EQ(verify_checksum("I,d,13,1*32").value(), "I,d,13,1");
    EXPECT_EQ(append_checksum(""), "*00");
}

TEST(Checksum, LowerCaseDigits_AreAccepted) {
    const auto line = append_checksum("@D,e,1,{7}");
    std::string lower = line;
    for (char& c : lower)
        c = (c >= 'A' && c <= 'F') ? static_cast<char>(c - 'A' + 'a') : c;
    lower[1] = 'D';
    EXPECT_TRUE(verify_checksum(lower));
}

TEST(Checksum, AnyFlippedBit_IsNoticed) {
    const auto line = append_checksum("S,W,0,90");
    for (std::size_t i = 0; i + 3 < line.size(); ++i) {
        for (int bit = 0; bit < 8; ++bit) {
            auto damaged = line;
            damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
            EXPECT_FALSE(verify_checksum(damaged)) << damaged;
        }
    }
}

TEST(Checksum, MissingOrCutOff_IsRefused) {
    for (const std::string_view line : {"", "*", "*0", "I,d,13,1", "I,d,13,1*", "I,d,13,1*3", "I,d,13,1*3g"})
        EXPECT_FALSE(verify_checksum(line)) << line;
}

}  // namespace
}  // namespace asip::protocol
