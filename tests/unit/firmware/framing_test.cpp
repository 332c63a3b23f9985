// SPDX-License-Identifier: Apache-2.0
// How bytes become requests: each way a line can be wrong is reported, does nothing, and the next one works.
#include <gtest/gtest.h>

#include "fake_board.hpp"

namespace asip {
namespace {

const std::string kFence = "@#,E,ok\n";

TEST(FramingTest, EachLineEndThatTerminalsSend_EndsOneRequestAtOnce) {
    const std::string version = "@#,?,0,4,ATmega328P,20,Test\n";
    for (const char* end : {"\n", "\r", "\r\n", "\n\r"}) {
        FakeBoard board;
        EXPECT_EQ(board.ask("I,P,13,3"), "");
        EXPECT_EQ(board.send(std::string("#,?") + end), version);
        EXPECT_EQ(board.send(std::string("I,d,13,1") + end + "#,?" + end), version);
        EXPECT_TRUE(board.hardware().levels[13]);
        EXPECT_EQ(board.send(std::string("#,E,ok") + end + "I,d,13,0" + end), kFence);
        EXPECT_FALSE(board.hardware().levels[13]) << "with extensions, too";
        EXPECT_EQ(board.pass_time(2000), "");
    }
}

TEST(FramingTest, WhatAnOldBoardSkipsBeforeARequest_DoesNotCount) {
    std::string skipped(1, '\0');
    for (char c = 1; c <= ' '; ++c)
        skipped += c;
    FakeBoard board;
    board.ask("I,P,13,3");
    EXPECT_EQ(board.send(skipped + "I,d,13,1\n"), "");
    EXPECT_TRUE(board.hardware().levels[13]);
    EXPECT_EQ(board.send("  #,E,ok\n"), kFence);
    EXPECT_EQ(board.send(skipped.substr(1) + "#,E,ok\n"), kFence);
    EXPECT_EQ(board.send(skipped.substr(1) + "\n"), "");
    EXPECT_EQ(board.pass_time(2000), "");
}

TEST(FramingTest, BytesLostBeforeARequest_SpoilItWhereAnExtensionIsInUse) {
    FakeBoard board;
    board.ask("I,P,13,3");
    board.ask("#,E,ok");
    EXPECT_EQ(board.send(std::string(1, '\0') + "I,d,13,1\n"), "~?,?,11{BAD_ARGUMENT}\n");
    EXPECT_FALSE(board.hardware().levels[13]);
    EXPECT_EQ(board.ask("#,E,ok"), kFence);
}

TEST(FramingTest, BytesThatComeOneByOne_AreARequestOnlyWhenTheLineEnds) {
    FakeBoard board;
    for (char c : std::string("#,E,ok")) {
        EXPECT_EQ(board.send(std::string(1, c)), "");
        EXPECT_EQ(board.pass_time(900), "");
    }
    EXPECT_EQ(board.send("\n"), kFence);
    board.send("#,E,o");
    EXPECT_EQ(board.pass_time(5000), "") << "an extension is in use: its peer ends its lines";
    EXPECT_EQ(board.send("k\n"), kFence);
}

TEST(FramingTest, SeveralRequestsAtOnce_AreAllExecutedInOrder) {
    FakeBoard board;
    EXPECT_EQ(board.send("#,E,1\n#,E,2\n#,E,3\n"), "@#,E,1\n@#,E,2\n@#,E,3\n");
}

TEST(FramingTest, EmptyLinesAndDebugText_AreIgnored) {
    FakeBoard board;
    EXPECT_EQ(board.send("\n\r\n!anything at all, I,d,13,1\n"), "");
    EXPECT_EQ(board.ask("#,E,ok"), kFence);
}

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

TEST(FramingTest, TagOfTwoCharacters_IsUnknown) {
    FakeBoard board;
    EXPECT_EQ(board.ask("I,dd,1"), "~I,d,2{UNKNOWN_REQUEST}\n");
    EXPECT_EQ(board.ask("I;d,1"), "~I,d,2{UNKNOWN_REQUEST}\n");
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

TEST(FramingTest, DamagedByteAnywhere_SpoilsItsLineOnly) {
    const std::string line = "I,d,13,1";
    for (std::size_t at = 1; at <= line.size(); ++at) {
        FakeBoard board;
        board.ask("I,P,13,3");
        std::string damaged = line;
        damaged.insert(at, 1, '\0');
        // As much of it is named as came before the damage.
        const std::string error = at < 3 ? "~I,?,11{BAD_ARGUMENT}\n" : "~I,d,11{BAD_ARGUMENT}\n";
        EXPECT_EQ(board.ask(damaged), error) << at;
        EXPECT_FALSE(board.hardware().levels[13]) << at;
        EXPECT_EQ(board.ask(line), "") << at;
        EXPECT_TRUE(board.hardware().levels[13]) << at;
    }
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
