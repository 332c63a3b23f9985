// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/clients/client_framing.hpp"

namespace asip::agent {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ClientFraming, PlainClient_SendsAndGetsLines) {
    ClientFraming framing;
    EXPECT_THAT(framing.decode("I,d,1"), IsEmpty());
    EXPECT_THAT(framing.decode("3,1\r\n#,?\n"), ElementsAre("I,d,13,1", "#,?"));
    EXPECT_EQ(framing.encode("@I,d,4,c"), "@I,d,4,c\n");
}

TEST(ClientFraming, JavaClient_SendsAndGetsFrames) {
    ClientFraming framing;
    EXPECT_THAT(framing.decode(std::string("\0\3#,", 4)), IsEmpty());
    EXPECT_THAT(framing.decode(std::string("?\0\4I,M\n", 7)), ElementsAre("#,?", "I,M"));
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4));
}

TEST(ClientFraming, EachLineEndThatTerminalsSend_EndsOneRequestAtOnce) {
    for (const std::string end : {"\n", "\r", "\r\n", "\n\r"}) {
        ClientFraming framing;
        EXPECT_THAT(framing.decode("#,?" + end), ElementsAre("#,?"));
        EXPECT_THAT(framing.decode("I,d,13,1" + end + "#,E,a" + end), ElementsAre("I,d,13,1", "#,E,a"));
        EXPECT_THAT(framing.decode("I,d,13,0" + end), ElementsAre("I,d,13,0"));
        EXPECT_FALSE(framing.waits_for_silence());
        ClientFraming frames;
        EXPECT_THAT(frames.decode(std::string("\0", 1) + static_cast<char>(3 + end.size()) + "#,?" + end),
                    ElementsAre("#,?"));
    }
}

TEST(ClientFraming, WhatBoardsSkipBeforeARequest_DoesNotCount) {
    ClientFraming lines;
    EXPECT_THAT(lines.decode("\t #,?\n"), ElementsAre("#,?"));
    EXPECT_THAT(lines.decode(std::string("\0\x1b  M,m,1,100M,m,0,5", 20)), ElementsAre("M,m,1,100"));
    EXPECT_THAT(lines.after_silence(), ElementsAre("M,m,0,5"));
    EXPECT_THAT(lines.decode("  "), IsEmpty());
    EXPECT_FALSE(lines.waits_for_silence());
    EXPECT_THAT(lines.decode(" #,I,aT,s\n"), ElementsAre("#,I,aT,s")) << "text is not cut";
    EXPECT_THAT(lines.take_halves(), IsEmpty());
}

TEST(ClientFraming, WhatBoardsIgnore_IsNoRequest) {
    ClientFraming lines;
    EXPECT_THAT(lines.decode("#,?  \n!debug\n \n\n#,N \r\n"), ElementsAre("#,?", "#,N"));
    ClientFraming frames;
    EXPECT_THAT(frames.decode(std::string("\0\4#,? \0\3!hi", 11)), ElementsAre("#,?"));
}

TEST(ClientFraming, NothingHeardYet_NothingIsSent) {
    ClientFraming framing;
    EXPECT_EQ(framing.encode("@I,d,4,c"), "");
    framing.decode(std::string("\0\3#,?", 5));
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4)) << "frames from the first one on";
}

TEST(ClientFraming, SilentClient_GetsLinesUntilItSendsAFrame) {
    ClientFraming framing;
    framing.assume(ClientFraming::Kind::kLines);
    EXPECT_EQ(framing.encode("@x"), "@x\n");
    EXPECT_THAT(framing.decode(std::string("\0\3#,?", 5)), ElementsAre("#,?"));
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4));
}

TEST(ClientFraming, SilentClientOfTheJavaPort_GetsFramesUntilItSendsALine) {
    ClientFraming framing;
    framing.assume(ClientFraming::Kind::kFrames);
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4));
    EXPECT_THAT(framing.decode("#,?\n"), ElementsAre("#,?"));
    EXPECT_EQ(framing.encode("@x"), "@x\n");
}

TEST(ClientFraming, RequestsWithoutLineEnd_EndWhereTheNextBeginsAndAfterSilence) {
    ClientFraming framing;
    EXPECT_THAT(framing.decode("E,A,25E,A,25R,A,25M,m,1,100M,m,0,-10"),
                ElementsAre("E,A,25", "E,A,25", "R,A,25", "M,m,1,100"));
    EXPECT_THAT(framing.decode("0"), IsEmpty());
    EXPECT_TRUE(framing.waits_for_silence());
    EXPECT_THAT(framing.after_silence(), ElementsAre("M,m,0,-100"));
    EXPECT_FALSE(framing.waits_for_silence());
    EXPECT_THAT(framing.decode("D,MI,A,0\nM,m,1,5I,d,13,1\n"),
                ElementsAre("D,M", "I,A,0", "M,m,1,5", "I,d,13,1"));
    EXPECT_THAT(framing.take_halves(), IsEmpty());
}

TEST(ClientFraming, RequestsWithoutLineEndSplitAtEveryPlace_AreTheSame) {
    const std::string bytes = "R,A,25M,m,1,100M,m,0,-100D,MI,d,13,1\n";
    for (std::size_t at = 0; at <= bytes.size(); ++at) {
        ClientFraming framing;
        auto requests = framing.decode(bytes.substr(0, at));
        for (auto& request : framing.decode(bytes.substr(at)))
            requests.push_back(request);
        EXPECT_THAT(requests, ElementsAre("R,A,25", "M,m,1,100", "M,m,0,-100", "D,M", "I,d,13,1")) << at;
        EXPECT_THAT(framing.take_halves(), IsEmpty()) << at;
    }
}

TEST(ClientFraming, HalfARequest_IsNeverExecutedNorJoinedWithAnother) {
    const std::string half = "M,m,1,100";
    for (std::size_t cut = 1; cut < 7; ++cut) {
        ClientFraming framing;
        EXPECT_THAT(framing.decode(half.substr(0, cut)), IsEmpty());
        EXPECT_THAT(framing.after_silence(), IsEmpty()) << cut;
        EXPECT_THAT(framing.take_halves(), ElementsAre(half.substr(0, cut)));
        EXPECT_THAT(framing.decode("I,d,13,1\n"), ElementsAre("I,d,13,1")) << cut;
    }
    ClientFraming framing;
    EXPECT_THAT(framing.decode("M,m,1,I,d,13,1\n"), ElementsAre("I,d,13,1"));
    EXPECT_THAT(framing.take_halves(), ElementsAre("M,m,1,"));
}

TEST(ClientFraming, ClientThatUsesAnExtension_EndsItsLines) {
    ClientFraming framing;
    EXPECT_THAT(framing.decode("#,E,t1\nM,m,1,100M,m,0,50"), ElementsAre("#,E,t1"));
    EXPECT_FALSE(framing.waits_for_silence());
    EXPECT_THAT(framing.decode("\n"), ElementsAre("M,m,1,100M,m,0,50")) << "the board refuses it";
}

TEST(ClientFraming, BurstWithoutLineEndsLongerThanALine_LosesNothing) {
    constexpr std::size_t kRequests = 400;
    std::string burst;
    for (std::size_t i = 0; i < kRequests; ++i)
        burst += "M,m,1,100";
    ClientFraming framing;
    EXPECT_THAT(framing.decode(burst), testing::SizeIs(kRequests - 1));
    EXPECT_THAT(framing.after_silence(), ElementsAre("M,m,1,100"));
}

TEST(ClientFraming, ExtensionBehindARequestWithoutLineEnd_IsInUse) {
    ClientFraming framing;
    EXPECT_THAT(framing.decode("D,M#,E,t1\n"), ElementsAre("D,M", "#,E,t1"));
    EXPECT_THAT(framing.decode("M,m,1,100M,m,0,50"), IsEmpty());
}

TEST(ClientFraming, FramingGiven_IsNotGuessed) {
    ClientFraming framing(ClientFraming::Kind::kFrames);
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4));
    EXPECT_THAT(framing.decode(std::string("\0\3#,?", 5)), ElementsAre("#,?"));
}

}  // namespace
}  // namespace asip::agent
