// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "firmware_board.hpp"
#include "pulses.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

TEST(ServosTest, AtStart_ServosTurnToTheMiddle) {
    FirmwareBoard board("asip_uno_services");
    Pulses pulses(board, 9);
    board->run_for(milliseconds(200));
    ASSERT_FALSE(pulses.widths.empty());
    for (double width : pulses.widths)
        EXPECT_NEAR(width, 1472, 12);
}

TEST(ServosTest, AngleBeyondItsBounds_IsTheBound) {
    FirmwareBoard board("asip_uno_services", "uno", {{"servo", {{"pin", 9}}, "pan"}});
    EXPECT_EQ(board.ask("S,W,0,200"), "");
    board->run_for(milliseconds(50));
    EXPECT_EQ(board->part("pan").state(), "180");
    EXPECT_EQ(board.ask("S,W,0, -20"), "");
    board->run_for(milliseconds(50));
    EXPECT_EQ(board->part("pan").state(), "0");
    EXPECT_EQ(board.ask("S,W,0,45.9"), "");
    board->run_for(milliseconds(50));
    EXPECT_NEAR(std::stod(board->part("pan").state()), 45, 1.1);
}

TEST(ServosTest, Angles_BecomePulsesOf544To2400MicrosecondsEach20Milliseconds) {
    for (int angle : {0, 45, 90, 135, 180}) {
        FirmwareBoard board("asip_uno_services");
        Pulses pulses(board, 9);
        EXPECT_EQ(board.ask("S,W,0," + std::to_string(angle)), "");
        board->run_for(milliseconds(500));
        ASSERT_GT(pulses.widths.size(), 20u);
        // Another interrupt may hold an edge up for some microseconds.
        for (double width : pulses.widths)
            EXPECT_NEAR(width, 544 + angle * 1856 / 180.0, 12) << angle;
        for (double period : pulses.periods)
            EXPECT_NEAR(period, 20000, 12);
    }
}

TEST(ServosTest, ServoParts_ShowTheirAngles) {
    FirmwareBoard board("asip_uno_services", "uno",
                        {{"servo", {{"pin", 9}}, "pan"}, {"servo", {{"pin", 10}}, "tilt"}});
    board.ask("S,W,0,30");
    board.ask("S,W,1,150");
    board->run_for(milliseconds(100));
    EXPECT_NEAR(std::stod(board->part("pan").state()), 30, 1.5);
    EXPECT_NEAR(std::stod(board->part("tilt").state()), 150, 1.5);
}

TEST(ServosTest, Remap_MovesTheServosAndFreesTheirPins) {
    FirmwareBoard board("asip_uno_services", "uno", {{"servo", {{"pin", 5}}, "pan"}});
    EXPECT_EQ(board.ask("S,M,1,5"), "");
    EXPECT_EQ(board.ask("#,S"), "@#,S,20,{@,@,I,I,I,S,I,D,D,I,I,I,I,I,I,I,I,I,I,I}");
    EXPECT_EQ(board.ask("S,W,1,90"), "~S,W,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(board.ask("S,W,0,90"), "");
    EXPECT_EQ(board.ask("I,P,9,3"), "");
    board->run_for(milliseconds(100));
    EXPECT_NEAR(std::stod(board->part("pan").state()), 90, 1.5);
}

TEST(ServosTest, EightServosAtFullWidth_ShareOneFrame) {
    FirmwareBoard board("asip_uno_services");
    EXPECT_EQ(board.ask("S,M,8,2,3,4,5,6,9,10,11"), "");
    Pulses pulses(board, 11);
    for (int servo = 0; servo < 8; ++servo)
        board.ask("S,W," + std::to_string(servo) + ",180");
    board->run_for(milliseconds(500));
    ASSERT_GT(pulses.periods.size(), 20u);
    EXPECT_NEAR(pulses.periods.back(), 20000, 12);
    EXPECT_NEAR(pulses.widths.back(), 2400, 12);
}

TEST(ServosTest, Restart_TurnsThemToTheMiddle) {
    FirmwareBoard board("asip_uno_services");
    board.ask("S,W,0,180");
    board.ask("#,R");
    board->run_for(milliseconds(30));
    Pulses pulses(board, 9);
    board->run_for(milliseconds(200));
    ASSERT_FALSE(pulses.widths.empty());
    EXPECT_NEAR(pulses.widths.back(), 1472, 12);
}

}  // namespace
}  // namespace asip::firmware
