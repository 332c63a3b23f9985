// SPDX-License-Identifier: Apache-2.0
// Timers that two services want: PWM is hidden and refused where a service uses its timer.
#include <gtest/gtest.h>

#include "firmware_board.hpp"
#include "pulses.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

constexpr std::uint16_t kTimerOcr0b = 0x48, kTccr0a = 0x44, kOcr3a = 0x98, kTccr3a = 0x90, kTccr3b = 0x91;

TEST(TimersTest, PwmOnAPinOfTheServosTimer_IsRefusedAndThePulsesStay) {
    FirmwareBoard board("asip_uno_services");
    EXPECT_EQ(board.ask("S,M,1,7"), "~S,M,3{INVALID_PIN}") << "a distance sensor has it";
    EXPECT_EQ(board.ask("S,M,1,6"), "");
    EXPECT_EQ(board.ask("S,W,0,90"), "");
    EXPECT_EQ(board.ask("I,P,9,5"), "~I,P,4{MODE_UNAVAILABLE}");
    EXPECT_EQ(board.ask("I,a,9,200"), "~I,a,3{INVALID_PIN}");
    EXPECT_EQ(board.ask("I,c"), "@I,c,20,{1,1,1,5,1,5,5,1,1,1,1,5,1,1,3,3,3,3,3,3}");
    Pulses pulses(board, 6);
    board->run_for(milliseconds(200));
    ASSERT_FALSE(pulses.widths.empty());
    for (double width : pulses.widths)
        EXPECT_NEAR(width, 1472, 12);
}

TEST(TimersTest, PwmOnAPinOfTheTonesTimer_IsRefused) {
    FirmwareBoard board("asip_uno_robot");
    EXPECT_EQ(board.ask("I,c"), "@I,c,20,{1,1,1,1,1,5,5,1,1,5,5,1,1,1,3,3,3,3,3,3}");
}

TEST(TimersTest, PwmPinThatIsClaimed_HasNoPwmAnyMore) {
    FirmwareBoard board("asip_uno_services");
    EXPECT_EQ(board.ask("I,a,5,100"), "");
    EXPECT_EQ(board->peek(kTccr0a) & 0x30, 0x20);
    EXPECT_EQ(board.ask("S,M,1,5"), "");
    EXPECT_EQ(board->peek(kTccr0a) & 0x30, 0);
    Pulses pulses(board, 5);
    board->run_for(milliseconds(200));
    ASSERT_GT(pulses.widths.size(), 8u);
    for (double width : pulses.widths)
        EXPECT_NEAR(width, 1472, 12);
}

TEST(TimersTest, MotorWhosePowerPinLosesItsPwmToTheServos_IsNotAvailable) {
    FirmwareBoard board("asip_uno_conflict");
    EXPECT_EQ(board.ask("M,m,0,100"), "~M,m,8{DEVICE_NOT_AVAILABLE}");
}

TEST(LeonardoTimersTest, ToneWhileMotorsRun_LeavesTheirPwm) {
    FirmwareBoard board("asip_leonardo_robot", "leonardo");
    board.ask("M,m,0,128");
    EXPECT_EQ(board->peek(kOcr3a), 128);
    int edges = 0;
    board->on_pin(22, [&](sim::Level) { ++edges; });  // A4
    EXPECT_EQ(board.ask("T,P,1000,100"), "");
    board->run_for(milliseconds(300));
    EXPECT_NEAR(edges, 200, 2);
    EXPECT_EQ(board->pin(22), sim::Level::kLow);
    EXPECT_EQ(board->peek(kOcr3a), 128);
    EXPECT_EQ(board->peek(kTccr3a), 0x81) << "8-bit phase-correct PWM on pin 5";
    EXPECT_EQ(board->peek(kTccr3b), 0x03);
}

TEST(LeonardoTimersTest, Tones_HaveTheirFrequencyUntilTheyAreEnded) {
    FirmwareBoard board("asip_leonardo_robot", "leonardo");
    int edges = 0;
    board->on_pin(22, [&](sim::Level) { ++edges; });
    for (const int hertz : {31, 440, 5000}) {
        board.ask("T,P," + std::to_string(hertz) + ",2000");
        edges = 0;
        board->run_for(milliseconds(500));
        EXPECT_NEAR(edges, hertz, 2);
        board.ask("T,P,0,0");
        EXPECT_EQ(board->pin(22), sim::Level::kLow);
        edges = 0;
        board->run_for(milliseconds(50));
        EXPECT_EQ(edges, 0);
    }
}

}  // namespace
}  // namespace asip::firmware
