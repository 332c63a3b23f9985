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

TEST(ClientFraming, FramingGiven_IsNotGuessed) {
    ClientFraming framing(ClientFraming::Kind::kFrames);
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4));
    EXPECT_THAT(framing.decode(std::string("\0\3#,?", 5)), ElementsAre("#,?"));
}

}  // namespace
}  // namespace asip::agent
