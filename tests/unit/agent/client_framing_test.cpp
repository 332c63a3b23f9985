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

TEST(ClientFraming, BurstWithoutLineEndsLongerThanALine_LosesNothing) {
    constexpr std::size_t kRequests = 400;
    std::string burst;
    for (std::size_t i = 0; i < kRequests; ++i)
        burst += "M,m,1,100";
    ClientFraming framing;
    EXPECT_THAT(framing.decode(burst), testing::SizeIs(kRequests - 1));
    EXPECT_THAT(framing.after_silence(), ElementsAre("M,m,1,100"));
}

TEST(ClientFraming, FramingGiven_IsNotGuessed) {
    ClientFraming framing(ClientFraming::Kind::kFrames);
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4));
    EXPECT_THAT(framing.decode(std::string("\0\3#,?", 5)), ElementsAre("#,?"));
}

}  // namespace
}  // namespace asip::agent
