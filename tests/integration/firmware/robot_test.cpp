// SPDX-License-Identifier: Apache-2.0
// The services of a robot: motors, encoders, bump and reflectance sensors, tone.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "quadrature.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

constexpr const char* kRobotImage = "asip_uno_robot";
constexpr std::uint16_t kOcr0a = 0x47, kOcr0b = 0x48;  // powers of motor 1 (pin 6) and 0 (pin 5)

TEST(RobotTest, Banner_NamesAllServices) {
    FirmwareBoard board(kRobotImage);
    EXPECT_EQ(board.banner(), "!AsipRobot running on ATmega328P with Services: I M E B R T ");
    EXPECT_EQ(board.ask("#,N"),
              "@#,N,6,{I:ASIP core IO,M:Motors,E:Encoders,B:Bump Sensors,R:IR Sensors,T:Tone}");
    EXPECT_EQ(board.ask("#,S"), "@#,S,20,{@,@,E,E,E,M,M,M,M,E,B,B,M,M,R,R,R,R,T,I}");
}

TEST(MotorsTest, Power_SetsDirectionAndPwm) {
    FirmwareBoard board(kRobotImage);
    EXPECT_EQ(board.ask("M,m,0,128"), "");
    EXPECT_EQ(board->pin(7), sim::Level::kHigh);
    EXPECT_EQ(board->pin(8), sim::Level::kLow);
    EXPECT_EQ(board->peek(kOcr0b), 128);
    EXPECT_EQ(board.ask("M,M,-100,200"), "");
    EXPECT_EQ(board->pin(7), sim::Level::kLow);
    EXPECT_EQ(board->pin(8), sim::Level::kHigh);
    EXPECT_EQ(board->pin(12), sim::Level::kHigh);
    EXPECT_EQ(board->peek(kOcr0b), 100);
    EXPECT_EQ(board->peek(kOcr0a), 200);
    EXPECT_EQ(board.ask("M,s,0"), "");
    EXPECT_EQ(board->pin(8), sim::Level::kLow);
    EXPECT_EQ(board->pin(12), sim::Level::kHigh);
    EXPECT_EQ(board.ask("M,S"), "");
    EXPECT_EQ(board->pin(12), sim::Level::kLow);
}

TEST(MotorsTest, PowerBeyondItsBounds_IsTheBound) {
    FirmwareBoard board(kRobotImage);
    EXPECT_EQ(board.ask("M,m,0,12.5"), "");
    EXPECT_EQ(board->peek(kOcr0b), 12);
    EXPECT_EQ(board.ask("M,M,-300, 254.9"), "");
    EXPECT_EQ(board->pin(8), sim::Level::kHigh);
    EXPECT_EQ(board->peek(kOcr0b), 12) << "full power needs no timer";
    EXPECT_EQ(board->pin(5), sim::Level::kHigh);
    EXPECT_EQ(board->peek(kOcr0a), 254);
}

TEST(MotorsTest, Errors_ChangeNothing) {
    FirmwareBoard board(kRobotImage);
    EXPECT_EQ(board.ask("M,m,2,1"), "~M,m,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(board.ask("M,m,0,x"), "~M,m,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("M,M,1"), "~M,M,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("M,S,0"), "~M,S,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("M,x"), "~M,x,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.ask("M,A,x"), "~M,A,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("M,E,"), "~M,E,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board->pin(7), sim::Level::kLow);
}

TEST(MotorsTest, EncodersAskedForByM_AreReportedAsThoseOfE) {
    FirmwareBoard board(kRobotImage);
    Quadrature wheels(board, {{2, 4}, {3, 9, true}});
    EXPECT_EQ(board.ask("M,A,1"), "");
    wheels.turn(100, milliseconds(2));
    long steps[2] = {0, 0}, lines = 0;
    for (const auto& line : board.lines_within(milliseconds(50))) {
        long left = 0, right = 0;
        ASSERT_EQ(std::sscanf(line.c_str(), "@M,e,2,{%*d:%ld,%*d:%ld}", &left, &right), 2) << line;
        steps[0] += left;
        steps[1] += right;
        ++lines;
    }
    EXPECT_NEAR(static_cast<double>(lines), 10, 1) << "each 25 ms";
    EXPECT_EQ(std::abs(steps[0]), 200);
    EXPECT_EQ(steps[1], steps[0]);
    board.ask("M,A,100");
    EXPECT_EQ(board.lines_within(milliseconds(1050)).size(), 10u);
    EXPECT_EQ(board.ask("M,A,0"), "");
    EXPECT_TRUE(board.lines_within(milliseconds(200)).empty());
}

TEST(BumpTest, Touched_IsZeroAndFreeIsOne) {
    FirmwareBoard board(kRobotImage, "uno",
                        {{"button", {{"pin", 10}, {"steady", true}}, "left"},
                         {"button", {{"pin", 11}, {"steady", true}}, "right"}});
    board.ask("B,A,20");
    EXPECT_EQ(board.next_line(), "@B,e,2,{1,1}");
    ASSERT_TRUE(board->part("right").command("press", ""));
    board.next_line();
    EXPECT_EQ(board.next_line(), "@B,e,2,{1,0}");
    EXPECT_EQ(board.ask("B,M").substr(0, 7), "~B,M,2{");
}

TEST(ReflectanceTest, Values_AreReadWithTheEmittersOn) {
    FirmwareBoard board(kRobotImage);
    board->set_millivolts(14, 0);
    board->set_millivolts(15, 2500);
    board->set_millivolts(16, 5000);
    int rises = 0;
    board->on_pin(17, [&](sim::Level level) { rises += level == sim::Level::kHigh; });
    board.ask("R,A,50");
    EXPECT_EQ(board.next_line(), "@R,e,3,{0,511,1023}");
    EXPECT_EQ(board.next_line(), "@R,e,3,{0,511,1023}");
    EXPECT_EQ(rises, 2);
    EXPECT_EQ(board->pin(17), sim::Level::kLow);
}

TEST(ToneTest, Tone_SoundsForItsTimeWhileTheBoardGoesOn) {
    FirmwareBoard board(kRobotImage);
    int edges = 0;
    board->on_pin(18, [&](sim::Level) { ++edges; });
    EXPECT_EQ(board.ask("T,P,1000,100"), "");
    EXPECT_EQ(board.ask("#,E,x"), "@#,E,x");
    board->run_for(milliseconds(300));
    EXPECT_NEAR(edges, 200, 4);
    EXPECT_EQ(board.ask("T,P,5,100"), "~T,P,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("T,P,440"), "~T,P,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("T,S"), "~T,S,2{UNKNOWN_REQUEST}");
}

}  // namespace
}  // namespace asip::firmware
