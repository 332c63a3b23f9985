// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

std::vector<sim::PartConfig> sensors(double first, double second) {
    return {{"ultrasonic", {{"pin", 7}, {"distance", first}}, "first"},
            {"ultrasonic", {{"pin", 8}, {"distance", second}}, "second"}};
}

TEST(DistanceTest, MeasureOnce_ReportsEachSensor) {
    FirmwareBoard board("asip_uno_services", "uno", sensors(42, 118));
    board.ask("D,M");
    EXPECT_EQ(board.next_line(), "@D,e,2,{42,118}");
    EXPECT_EQ(board.next_line(), "(none)");
}

TEST(DistanceTest, EveryDistance_IsWithinACentimetre) {
    for (int cm = 4; cm < 400; cm += 33) {
        FirmwareBoard board("asip_uno_services", "uno", sensors(cm, 400 - cm));
        board.ask("I,A,20");  // conversions in between must not matter
        board.ask("D,M");
        std::string line;
        do
            line = board.next_line();
        while (line.starts_with("@I,a"));
        int first = 0, second = 0;
        ASSERT_EQ(std::sscanf(line.c_str(), "@D,e,2,{%d,%d}", &first, &second), 2) << line;
        EXPECT_NEAR(first, cm, 1);
        EXPECT_NEAR(second, 400 - cm, 1);
    }
}

TEST(DistanceTest, NothingInRange_IsZeroAndDoesNotSpoilTheNextMeasurement) {
    FirmwareBoard board("asip_uno_services", "uno", sensors(1000, 50));
    board.ask("D,M");
    EXPECT_EQ(board.next_line(), "@D,e,2,{0,50}");
    ASSERT_TRUE(board->part("first").command("set", "10"));
    board.ask("D,M");
    EXPECT_EQ(board.next_line(), "@D,e,2,{10,50}");
}

TEST(DistanceTest, NoSensorConnected_IsZero) {
    FirmwareBoard board("asip_uno_services");
    board.ask("D,M");
    EXPECT_EQ(board.next_line(), "@D,e,2,{0,0}");
}

TEST(DistanceTest, AutoEvents_ComeEachPeriodAndStop) {
    FirmwareBoard board("asip_uno_services", "uno", sensors(42, 118));
    board.ask("D,A,100");
    const auto lines = board.lines_within(milliseconds(1050));
    EXPECT_EQ(lines.size(), 10u);
    for (const auto& line : lines)
        EXPECT_EQ(line, "@D,e,2,{42,118}");
    board.ask("D,A,0");
    board->run_for(milliseconds(100));
    board->take_output();
    EXPECT_EQ(board.next_line(), "(none)");
}

TEST(DistanceTest, PeriodShorterThanAMeasurement_MeasuresWithoutPause) {
    FirmwareBoard board("asip_uno_services", "uno", sensors(200, 200));
    board.ask("D,A,1");
    const auto lines = board.lines_within(milliseconds(1000));
    EXPECT_GT(lines.size(), 30u);  // two echoes of 11.7 ms each
}

// The board must never be away for more than a millisecond while it measures.
TEST(DistanceTest, WhileMeasuring_TheBoardAnswersAsFastAsEver) {
    FirmwareBoard board("asip_uno_services", "uno", sensors(390, 1000));
    board.step_up(500000);
    board.ask("D,A,1");
    sim::Cycles longest = 0;
    for (int i = 0; i < 300; ++i) {
        board->run_for(std::chrono::microseconds(731));
        const auto begin = board->cycles();
        board->send("#,E,a\n");
        std::string line;
        sim::Cycles end = 0;
        do {
            const auto got = board->read_line(milliseconds(20));
            ASSERT_TRUE(got);
            line = got->text;
            end = got->cycle;
        } while (line != "@#,E,a");
        longest = std::max(longest, end - begin);
    }
    // 13 bytes on the wire are 0.26 ms; an event of the sensors may be before the answer: 0.3 ms more.
    EXPECT_LT(static_cast<double>(longest) / 16000, 1.0);
}

TEST(DistanceTest, OnPinsWithoutInterrupt_TheLoopTimesTheEcho) {
    // Pins 7 and 8 of a Mega have no pin-change interrupt.
    FirmwareBoard board("asip_mega_services", "mega", sensors(42, 300));
    board.ask("D,M");
    int first = 0, second = 0;
    const auto line = board.next_line();
    ASSERT_EQ(std::sscanf(line.c_str(), "@D,e,2,{%d,%d}", &first, &second), 2) << line;
    EXPECT_NEAR(first, 42, 1);
    EXPECT_NEAR(second, 300, 2);
}

}  // namespace
}  // namespace asip::firmware
