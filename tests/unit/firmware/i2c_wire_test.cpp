// SPDX-License-Identifier: Apache-2.0
// Transfers in parts by the Wire of an Arduino core: what goes over the wires, and that the bus is free in
// the end.
#include <gtest/gtest.h>

#include <array>

#define ASIP_SDA 6
#define ASIP_SCL 7
#include "Arduino.h"
#include "asip/I2cWire.h"

namespace asip {
namespace {

class I2cWireTest : public testing::Test {
  protected:
    void SetUp() override {
        Wire = {};
        wire::begin();
    }
    I2c::Fault part(int way, int count = 1, int address = 60) {
        return wire::part(static_cast<std::uint8_t>(way | I2c::kParts), static_cast<std::uint8_t>(address),
                          bytes_.data(), static_cast<std::uint8_t>(count));
    }
    static I2c::Fault end() { return wire::part(0, 0, nullptr, 0); }

    std::array<std::uint8_t, 40> bytes_{};
};

TEST_F(I2cWireTest, PartsThatEnd_AreOneTransfer) {
    EXPECT_EQ(part(0, 3), I2c::kNoFault);
    EXPECT_EQ(part(I2c::kGoOn, 2), I2c::kNoFault);
    EXPECT_EQ(part(I2c::kRead | I2c::kStop, 4), I2c::kNoFault);
    EXPECT_EQ(Wire.seen, "Sw5Sr4P");
    EXPECT_EQ(bytes_[3], 0x5A);
}

TEST_F(I2cWireTest, ReadThatCannotBeDone_FreesTheBusAndIsAFault) {
    part(0, 1);
    EXPECT_EQ(part(I2c::kRead | I2c::kMore, 16), I2c::kTooLong);
    EXPECT_EQ(Wire.seen, "Sw1P");
    EXPECT_EQ(part(I2c::kRead | I2c::kMore, 16), I2c::kTooLong);
    EXPECT_EQ(Wire.seen, "Sw1P") << "nothing was open";
}

TEST_F(I2cWireTest, ReadWithoutAStop_IsEndedWhereNothingFollows) {
    part(0, 1);
    EXPECT_EQ(part(I2c::kRead, 2), I2c::kNoFault);
    EXPECT_TRUE(Wire.owned);
    EXPECT_EQ(end(), I2c::kNoFault);
    EXPECT_EQ(Wire.seen, "Sw1Sr2Sw0P");
    EXPECT_EQ(end(), I2c::kNoFault);
    EXPECT_EQ(Wire.seen, "Sw1Sr2Sw0P") << "once";
}

TEST_F(I2cWireTest, EachFault_FreesTheBus) {
    part(0, 1);
    EXPECT_EQ(part(I2c::kRead, 2, 61), I2c::kNoAddress);
    EXPECT_FALSE(Wire.owned) << Wire.seen;
    part(0, 1, 61);
    EXPECT_EQ(part(I2c::kRead, 2, 61), I2c::kNoAddress);
    EXPECT_FALSE(Wire.owned) << Wire.seen;
    part(0, 1);
    part(I2c::kRead, 1);
    EXPECT_EQ(part(0, 33), I2c::kTooLong);
    EXPECT_FALSE(Wire.owned) << Wire.seen;
}

TEST_F(I2cWireTest, BusThatBeginsAnew_HasNothingOpen) {
    part(0, 3);
    wire::begin();
    EXPECT_EQ(part(I2c::kRead | I2c::kStop, 2), I2c::kNoFault);
    EXPECT_EQ(Wire.seen, "Sr2P");
}

}  // namespace
}  // namespace asip
