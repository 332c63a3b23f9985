// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/pin.hpp"

#include <gtest/gtest.h>

namespace asip::protocol {
namespace {

TEST(PinMode, EachMode_IsFoundByItsTextAndItsNumber) {
    for (int number = 0; number <= 8; ++number) {
        const auto mode = pin_mode_from_number(number);
        ASSERT_TRUE(mode);
        EXPECT_EQ(pin_mode_from_text(to_text(*mode)), mode);
        EXPECT_EQ(pin_mode_from_text(std::to_string(number)), mode);
    }
}

TEST(PinMode, OtherSpellings_AreUnderstood) {
    EXPECT_EQ(pin_mode_from_text("INPUT_PULLUP"), PinMode::kInputPullup);
    EXPECT_EQ(pin_mode_from_text("Pullup"), PinMode::kInputPullup);
}

TEST(PinMode, UnknownTextOrNumber_IsNothing) {
    EXPECT_FALSE(pin_mode_from_number(9));
    EXPECT_FALSE(pin_mode_from_number(-1));
    for (const std::string_view text : {"", "9", "outptu", "3 "})
        EXPECT_FALSE(pin_mode_from_text(text)) << text;
}

}  // namespace
}  // namespace asip::protocol
