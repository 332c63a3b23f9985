// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "fake_board.hpp"

namespace asip {
namespace {

TEST(IoServiceTest, InputMode_SendsThePortAtOnceWithAllItsInputs) {
    FakeBoard board;
    board.hardware().levels[3] = true;
    board.hardware().levels[7] = true;
    board.settle();
    EXPECT_EQ(board.ask("I,P,2,1"), "@I,d,4,88\n");
}

TEST(IoServiceTest, PullUp_ReadsHigh) {
    FakeBoard board;
    EXPECT_EQ(board.ask("I,P,2,2"), "@I,d,4,4\n");
    EXPECT_EQ(board.hardware().modes[2], hw::FakeMode::kPullUp);
}

TEST(IoServiceTest, ChangeOfAnInput_IsSentOnceForItsPort) {
    FakeBoard board;
    board.hardware().levels[2] = true;
    EXPECT_EQ(board.settle(), "@I,d,4,4\n");
    board.hardware().levels[13] = true;
    board.hardware().levels[8] = true;
    EXPECT_EQ(board.settle(), "@I,d,2,21\n");
    EXPECT_EQ(board.settle(), "");
}

TEST(IoServiceTest, PinsThatAreHighAtStart_AreAnEventForTheirPort) {
    FakeBoard board;
    FakeBoard::switch_on();
    board.hardware().levels[4] = true;
    board.hardware().levels[6] = true;
    asip::board.begin(F("Test"));
    asip::board.io().setPeriod(0);
    EXPECT_EQ(board.settle(), "!Test running on ATmega328P with Services: I \n@I,d,4,50\n");
}

TEST(IoServiceTest, PinThatCeasesToBeAnInput_LeavesThePortsStateWithoutAnEvent) {
    FakeBoard board;
    board.hardware().levels[2] = true;
    board.settle();
    EXPECT_EQ(board.ask("I,P,2,3"), "");
    EXPECT_EQ(board.settle(), "");
    board.hardware().levels[3] = true;
    EXPECT_EQ(board.settle(), "@I,d,4,8\n");
}

TEST(IoServiceTest, FullLine_KeepsTheLastChangeForLater) {
    FakeBoard board;
    board.hardware().room = 3;
    board.hardware().levels[2] = true;
    asip::board.run();
    EXPECT_EQ(board.hardware().from_board, "");
    board.hardware().levels[3] = true;
    board.hardware().room = 63;
    EXPECT_EQ(board.settle(), "@I,d,4,C\n");
}

TEST(IoServiceTest, Levels_AreThoseOfTheInputsOfEveryPortAndSetNothing) {
    FakeBoard board;
    EXPECT_EQ(board.ask("I,L"), "@I,L,3,{2:0,3:0,4:0}\n");
    board.ask("I,P,13,3");
    board.ask("I,d,13,1");
    board.ask("I,P,2,2");
    board.hardware().levels[8] = true;
    EXPECT_EQ(board.settle(), "@I,d,2,1\n");
    const auto modes = board.hardware().modes;
    EXPECT_EQ(board.ask("I,L"), "@I,L,3,{2:1,3:0,4:4}\n") << "pin 13 is high, but no input";
    EXPECT_EQ(board.ask("I,L"), "@I,L,3,{2:1,3:0,4:4}\n");
    EXPECT_EQ(board.hardware().modes, modes);
    EXPECT_EQ(board.ask("I,L,1"), "~I,L,11{BAD_ARGUMENT}\n");
}

TEST(IoServiceTest, ChangeThatLevelsShowedFirst_IsAnEventAllTheSame) {
    FakeBoard board;
    board.hardware().levels[2] = true;
    EXPECT_EQ(board.send("I,L\n"), "@I,d,4,4\n@I,L,3,{2:0,3:0,4:4}\n");
    board.hardware().room = 42;
    board.hardware().to_board = "I,L\n";
    asip::board.run();
    board.hardware().levels[9] = true;
    const auto lines = board.settle();
    EXPECT_NE(lines.find("@I,d,2,2\n"), std::string::npos) << lines;
}

TEST(IoServiceTest, LevelsOfABoardWithoutInputs_AreAllZero) {
    FakeBoard board({}, true);
    board.hardware().levels[2] = true;
    EXPECT_EQ(board.ask("I,L"), "@I,L,3,{2:0,3:0,4:0}\n");
}

TEST(IoServiceTest, DigitalWrite_IsAllowedToInputsForTheirPullUps) {
    FakeBoard board;
    EXPECT_EQ(board.ask("I,d,2,1"), "");
    EXPECT_EQ(board.ask("I,P,4,2"), "@I,d,4,10\n");
    EXPECT_EQ(board.ask("I,d,4,0"), "");
}

TEST(IoServiceTest, PwmWriteInAnotherMode_SetsItsModeAndPwmEndsWithIt) {
    FakeBoard board;
    EXPECT_EQ(board.ask("I,a,3,200"), "");
    EXPECT_EQ(board.hardware().duty[3], 200);
    EXPECT_EQ(board.hardware().modes[3], hw::FakeMode::kOutput);
    EXPECT_EQ(board.ask("I,a,3, 64"), "");
    EXPECT_EQ(board.hardware().duty[3], 64);
    EXPECT_EQ(board.ask("I,p"), "@I,p,20,{6,6,1,5,1,1,1,1,1,1,1,1,1,1,4,4,4,4,4,4}\n");
    EXPECT_EQ(board.ask("I,d,3,1"), "~I,d,6{WRONG_MODE}\n");
    EXPECT_EQ(board.ask("I,P,3,3"), "");
    EXPECT_EQ(board.hardware().duty[3], -1);
}

TEST(IoServiceTest, AnalogEvents_HaveThePinsInAnalogMode) {
    FakeBoard board;
    board.hardware().analog = {0, 1023, 42, 7, 8, 9};
    EXPECT_EQ(board.ask("I,P,14,1"), "@I,d,3,0\n");
    EXPECT_EQ(board.ask("I,P,17,0"), "");
    board.ask("I,A,100");
    EXPECT_EQ(board.pass_time(99), "");
    EXPECT_EQ(board.pass_time(2), "@I,a,4,{1:1023,2:42,4:8,5:9}\n");
    board.ask("I,A,0");
    EXPECT_EQ(board.pass_time(500), "");
}

TEST(IoServiceTest, NoAnalogPin_NoAnalogEvent) {
    FakeBoard board;
    for (int pin = 14; pin < 20; ++pin)
        board.ask("I,P," + std::to_string(pin) + ",0");
    board.ask("I,A,10");
    EXPECT_EQ(board.pass_time(200), "");
}

TEST(IoServiceTest, AnalogPeriodAfterStart_Is50Milliseconds) {
    FakeBoard fresh;
    FakeBoard::switch_on();
    board.begin(F("Test"));
    fresh.settle();
    EXPECT_EQ(fresh.pass_time(100), "@I,a,6,{0:0,1:0,2:0,3:0,4:0,5:0}\n@I,a,6,{0:0,1:0,2:0,3:0,4:0,5:0}\n");
}

}  // namespace
}  // namespace asip
