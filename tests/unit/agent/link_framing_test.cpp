// SPDX-License-Identifier: Apache-2.0
#include "agent/port/link_framing.hpp"

#include <gtest/gtest.h>

namespace asip::agent {
namespace {

using Kind = LinkFraming::Kind;
using namespace std::string_literals;

TEST(LinkFraming, Frames_CarryOneLineEach) {
    LinkFraming framing(Kind::kFrames, Kind::kLines);
    EXPECT_EQ(framing.outgoing("#,?\nI,M"), "\0\4#,?\n"s);
    EXPECT_EQ(framing.outgoing("\n"), "\0\4I,M\n"s);
    EXPECT_EQ(framing.incoming("\0\x08@I,d,4,4\0\7@I,d"s), "@I,d,4,4\n");
    EXPECT_EQ(framing.incoming(",4"), "");
    framing.opened();
    EXPECT_EQ(framing.outgoing("x\n"), "\0\2x\n"s);
    EXPECT_EQ(framing.incoming("\0\2a\n"s), "a\n") << "half a frame was of the connection before";
}

TEST(LinkFraming, FramingThatIsNotGiven_IsThatOfTheOtherSide) {
    LinkFraming framing(Kind::kUnknown, Kind::kLines);
    EXPECT_EQ(framing.outgoing("#,?\n"), "#,?\n");
    EXPECT_EQ(framing.incoming("\0\2ab"s), std::nullopt) << "what was sent meant something else";
    framing.opened();
    EXPECT_EQ(framing.outgoing("#,?\n"), "\0\4#,?\n"s);
    EXPECT_EQ(framing.incoming("\0\2ab"s), "ab\n");
    framing.opened();
    EXPECT_EQ(framing.incoming("@I"), std::nullopt);
    framing.opened();
    EXPECT_EQ(framing.incoming("@I"), "@I");
    EXPECT_EQ(framing.incoming("\0"s), "\0"s) << "the first byte decides";
}

TEST(LinkFraming, FramingThatIsGiven_IsNotGuessed) {
    LinkFraming framing(Kind::kLines, Kind::kFrames);
    EXPECT_EQ(framing.incoming("\0\2ab"s), "\0\2ab"s);
}

}  // namespace
}  // namespace asip::agent
