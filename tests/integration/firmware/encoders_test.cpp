// SPDX-License-Identifier: Apache-2.0
// Wheel encoders of AsipRobot: 0 on pins 2 and 4, 1 on pins 3 and 9.
#include <gtest/gtest.h>

#include <cstdio>

#include "quadrature.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

constexpr const char* kImage = "asip_uno_robot";

struct Report {
    long pulse[2] = {0, 0};
    long steps[2] = {0, 0};
};

bool parse(const std::string& line, Report& report) {
    return std::sscanf(line.c_str(), "@E,e,2,{%ld:%ld,%ld:%ld}", &report.pulse[0], &report.steps[0],
                       &report.pulse[1], &report.steps[1]) == 4;
}

Report next_report(FirmwareBoard& board) {
    Report report;
    const auto line = board.next_line();
    EXPECT_TRUE(parse(line, report)) << line;
    return report;
}

/// Adds up the steps of all reports that came.
void add_reports(FirmwareBoard& board, long (&total)[2]) {
    for (const auto& line : board.lines_within(1ms)) {
        Report report;
        if (!parse(line, report)) continue;
        total[0] += report.steps[0];
        total[1] += report.steps[1];
    }
}

TEST(EncodersTest, Cycles_AreTwoStepsEachWithTheirDirectionAndTheTimeOfOneEdge) {
    FirmwareBoard board(kImage);
    Quadrature wheels(board, {{2, 4}, {3, 9, true}});
    board.ask("E,A,1100");
    wheels.turn(200, 5020us);
    const auto report = next_report(board);
    EXPECT_EQ(report.steps[0], 400);
    EXPECT_EQ(report.steps[1], 400) << "mirrored, and counted so";
    EXPECT_NEAR(report.pulse[0], 2510, 12);
    EXPECT_NEAR(report.pulse[1], 2510, 12);
}

TEST(EncodersTest, WheelThatStands_KeepsItsPulseAndHasNoSteps) {
    FirmwareBoard board(kImage);
    Quadrature wheels(board, {{2, 4}, {3, 9}});
    wheels.turn(3, 200ms);
    board.ask("E,A,20");
    EXPECT_EQ(next_report(board).steps[0], 6);
    for (int i = 0; i < 3; ++i) {
        const auto report = next_report(board);
        EXPECT_EQ(report.steps[0], 0);
        EXPECT_NEAR(report.pulse[0], 100'000, 12) << "more than 16 bits";
    }
}

TEST(EncodersTest, StepsWithReportsOff_AreCountedBeyond16Bits) {
    FirmwareBoard board(kImage);
    Quadrature wheels(board, {{2, 4}});
    wheels.turn(17'000, 250us);
    board.ask("E,A,20");
    EXPECT_EQ(next_report(board).steps[0], 34'000);
}

TEST(EncodersTest, TwoWheelsAt4KilohertzUnderAFloodOfBadRequests_LoseNoStep) {
    FirmwareBoard board(kImage);
    Quadrature wheels(board, {{2, 4}, {3, 9, true}});
    for (const char* request : {"E,A,25", "B,A,25", "R,A,25", "I,A,25"})
        board.ask(request);
    long total[2] = {0, 0};
    for (int tenth = 0; tenth < 4; ++tenth) {
        for (int i = 0; i < 150; ++i)
            board->send("Z,x\n");
        wheels.turn(400, 250us);
        add_reports(board, total);
    }
    board->send("\n");
    board->run_for(200ms);
    add_reports(board, total);
    EXPECT_EQ(total[0], 3200);
    EXPECT_EQ(total[1], 3200);
}

TEST(EncodersTest, Restart_BeginsAnew) {
    FirmwareBoard board(kImage);
    Quadrature wheels(board, {{2, 4}});
    wheels.turn(10, 1ms);
    board.ask("#,R");
    board.ask("E,A,20");
    const auto report = next_report(board);
    EXPECT_EQ(report.steps[0], 0);
    EXPECT_EQ(report.pulse[0], 0);
}

// Pins 2 and 3 of a Mega and a Leonardo have external interrupts only.
class EncoderBoardsTest : public testing::TestWithParam<const char*> {};

TEST_P(EncoderBoardsTest, StepsAt4Kilohertz_AreAllCounted) {
    const std::string kind = GetParam();
    FirmwareBoard board("asip_" + kind + "_robot", kind);
    Quadrature wheels(board, {{2, 4}, {3, 9, true}});
    wheels.turn(500, 250us);
    board.ask("E,A,20");
    const auto report = next_report(board);
    EXPECT_EQ(report.steps[0], 1000);
    EXPECT_EQ(report.steps[1], 1000);
    EXPECT_NEAR(report.pulse[0], 125, 12);
}

INSTANTIATE_TEST_SUITE_P(All, EncoderBoardsTest, testing::Values("uno", "mega", "leonardo"),
                         [](const auto& chosen) { return std::string(chosen.param); });

}  // namespace
}  // namespace asip::firmware
