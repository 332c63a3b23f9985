// SPDX-License-Identifier: Apache-2.0
// The words for lines that are wrong, and lines that wait for each other. tests/firmware tries each short
// input.
#include <gtest/gtest.h>

#include "fake_board.hpp"

namespace asip {
namespace {

const std::string kFence = "@#,E,ok\n";

TEST(FramingTest, UnknownService_IsReportedAsTheProtocolSays) {
    FakeBoard board;
    EXPECT_EQ(board.ask("Z,x,1"), "~Z,?,1{INVALID_SERVICE}\n");
    EXPECT_EQ(board.ask("hello"), "~h,?,1{INVALID_SERVICE}\n");
    EXPECT_EQ(board.ask("\x80\xFF"), "~?,?,1{INVALID_SERVICE}\n");
    EXPECT_EQ(board.ask("#,E,ok"), kFence);
}

TEST(FramingTest, ShortRequests_AreAnsweredAtOnce) {
    FakeBoard board;
    EXPECT_EQ(board.ask("I"), "~I,?,2{UNKNOWN_REQUEST}\n");
    EXPECT_EQ(board.ask("I,"), "~I,?,2{UNKNOWN_REQUEST}\n");
    EXPECT_EQ(board.ask("I,z"), "~I,z,2{UNKNOWN_REQUEST}\n");
    EXPECT_EQ(board.ask("#"), "~#,?,2{UNKNOWN_REQUEST}\n");
    EXPECT_EQ(board.ask(",x"), "~,,?,1{INVALID_SERVICE}\n");
    EXPECT_EQ(board.ask("x"), "~x,?,1{INVALID_SERVICE}\n");
}

TEST(FramingTest, TagThatCannotBePrinted_IsReportedAsAQuestionMark) {
    FakeBoard board;
    EXPECT_EQ(board.ask("I,\x07"), "~I,?,2{UNKNOWN_REQUEST}\n");
}

TEST(FramingTest, LongestLine_IsTaken) {
    FakeBoard board;
    const std::string line = "I,A," + std::string(kMaxRequestLength - 4 - 2, '0') + "50";
    ASSERT_EQ(line.size(), kMaxRequestLength);
    EXPECT_EQ(board.ask(line), "");
    EXPECT_EQ(asip::board.io().period(), 50);
}

TEST(FramingTest, TooLongForBuffer_DropsLineAndRecovers) {
    FakeBoard board;
    const std::string line = "I,A," + std::string(kMaxRequestLength - 4 - 1, '0') + "50";
    EXPECT_EQ(board.ask(line), "~I,A,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(asip::board.io().period(), 0);
    EXPECT_EQ(board.ask(std::string(100000, 'I')), "~I,I,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.ask("#,E,ok"), kFence);
}

TEST(FramingTest, RequestBehindAList_WaitsForItsEnd) {
    FakeBoard board;
    EXPECT_EQ(board.send("I,m\n#,E,ok\n"), "@I,m,6,{14:0,15:1,16:2,17:3,18:4,19:5}\n" + kFence);
}

TEST(FramingTest, ListOnAFullLine_ComesOutWholeWithoutWaiting) {
    FakeBoard board;
    std::string all;
    board.hardware().to_board = "I,p\n";
    for (int pass = 0; pass < 1000; ++pass) {
        asip::board.run();
        all += board.hardware().from_board;
        board.hardware().from_board.clear();
        // One byte leaves the ring in each pass.
        if (board.hardware().room < 63) ++board.hardware().room;
    }
    EXPECT_EQ(all, "@I,p,20,{6,6,1,1,1,1,1,1,1,1,1,1,1,1,4,4,4,4,4,4}\n");
    EXPECT_EQ(board.hardware().waits, 0u);
}

}  // namespace
}  // namespace asip
