// SPDX-License-Identifier: Apache-2.0
#include "asip/Out.h"

#include <gtest/gtest.h>

#include <utility>

#include "FakeHardware.h"

namespace asip {
namespace {

class OutTest : public testing::Test {
  protected:
    void SetUp() override {
        hw::reset_fake();
        out = Out();
    }
    static std::string take() { return std::exchange(hw::fake.from_board, {}); }
};

TEST_F(OutTest, Numbers_AreDecimalWithoutLeadingZeros) {
    for (unsigned value :
         {0u, 1u, 9u, 10u, 99u, 100u, 101u, 999u, 1000u, 1001u, 9999u, 10000u, 10010u, 65535u}) {
        out.number(static_cast<std::uint16_t>(value));
        EXPECT_EQ(take(), std::to_string(value));
    }
}

TEST_F(OutTest, SignedNumbers_ReachBothEnds) {
    for (int value : {-32768, -32767, -255, -1, 0, 1, 32767}) {
        out.signedNumber(static_cast<std::int16_t>(value));
        EXPECT_EQ(take(), std::to_string(value));
    }
}

TEST_F(OutTest, HexByte_HasNoLeadingZeroAndLargeLetters) {
    out.hexByte(0);
    out.character(' ');
    out.hexByte(15);
    out.character(' ');
    out.hexByte(0xAB);
    EXPECT_EQ(take(), "0 F AB");
}

TEST_F(OutTest, EveryError_HasItsNumberAndName) {
    const char* const names[] = {"NO_ERROR",        "INVALID_SERVICE",       "UNKNOWN_REQUEST",
                                 "INVALID_PIN",     "MODE_UNAVAILABLE",      "INVALID_MODE",
                                 "WRONG_MODE",      "INVALID_DEVICE_NUMBER", "DEVICE_NOT_AVAILABLE",
                                 "I2C_NOT_ENABLED", "BAD_CHECKSUM",          "BAD_ARGUMENT"};
    for (unsigned number = 0; number < 12; ++number) {
        out.error('I', 'd', static_cast<Error>(number));
        EXPECT_EQ(take(), "~I,d," + std::to_string(number) + "{" + names[number] + "}\n");
    }
}

TEST_F(OutTest, Checksum_CoversWhatIsBeforeTheStarAndStartsAnewWithEachLine) {
    out.useChecksum(true);
    for (int line = 0; line < 2; ++line) {
        out.text("@I,d,4,4");
        out.end();
        unsigned sum = 0;
        for (char c : std::string("@I,d,4,4"))
            sum ^= static_cast<unsigned>(c);
        char expected[32];
        std::snprintf(expected, sizeof expected, "@I,d,4,4*%02X\n", sum);
        EXPECT_EQ(take(), expected);
    }
}

TEST_F(OutTest, Room_IsNoneWhileTheLineIsHeldOrTakesNoWholePiece) {
    EXPECT_TRUE(out.hasRoom());
    out.hold(true);
    EXPECT_FALSE(out.hasRoom());
    EXPECT_TRUE(out.hasRoomForPiece());
    out.hold(false);
    hw::fake.room = Out::kLongestPiece - 1;
    EXPECT_FALSE(out.hasRoom());
    hw::fake.room = Out::kLongestPiece;
    EXPECT_TRUE(out.hasRoom());
}

TEST_F(OutTest, LongNumbers_AreWrittenInFull) {
    out.longNumber(0);
    out.character(',');
    out.longNumber(65536);
    out.character(',');
    out.longNumber(4294967295u);
    out.character(',');
    out.signedLongNumber(-2147483647 - 1);
    out.character(',');
    out.signedLongNumber(2147483647);
    EXPECT_EQ(take(), "0,65536,4294967295,-2147483648,2147483647");
}

}  // namespace
}  // namespace asip
