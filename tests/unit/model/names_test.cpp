// SPDX-License-Identifier: Apache-2.0
#include "asip/model/names.hpp"

#include <gtest/gtest.h>

#include "asip/model/board_state.hpp"

namespace asip::model {
namespace {

TEST(ValidName, LettersDigitsDotUnderscoreDash_AreAllowed) {
    EXPECT_TRUE(valid_name("uno1"));
    EXPECT_TRUE(valid_name("A-Z_0.9"));
    EXPECT_TRUE(valid_name(std::string(64, 'x')));
}

TEST(ValidName, AnythingElse_IsNot) {
    for (const std::string_view name :
         {"", "a b", "a/b", "a+", "#", "$state", "\xc3\xa4", "a\n", "a{", ".", ".."})
        EXPECT_FALSE(valid_name(name)) << name;
    EXPECT_TRUE(valid_name("...")) << "which is no folder";
    EXPECT_FALSE(valid_name(std::string(65, 'x')));
    EXPECT_FALSE(valid_name(std::string_view("a\0b", 3)));
}

TEST(ValidBoardName, ReservedNames_AreNot) {
    EXPECT_TRUE(valid_name("registry"));
    EXPECT_FALSE(valid_board_name("registry"));
    EXPECT_FALSE(valid_board_name("servicebus"));
    EXPECT_FALSE(valid_board_name("$probe"));
    EXPECT_TRUE(valid_board_name("registry2"));
}

TEST(ExplainBoardName, EachFault_HasItsSentence) {
    EXPECT_EQ(explain_board_name("uno1"), "");
    EXPECT_EQ(explain_board_name(""), "the name is empty");
    EXPECT_EQ(explain_board_name("registry"), "'registry' is reserved");
    EXPECT_EQ(explain_board_name(".."), "'..' is a folder in paths and addresses, and no name");
    EXPECT_EQ(explain_board_name("a\x1b b"),
              "'a\\x1b b' is not a name: allowed are letters, digits and . _ -");
    EXPECT_LT(explain_board_name(std::string(100000, 'x')).size(), 200u);
}

TEST(SuggestName, AnyText_GivesAValidName) {
    EXPECT_EQ(suggest_name("My Uno (left)"), "My-Uno-left");
    EXPECT_EQ(suggest_name("/dev/ttyACM0"), "dev-ttyACM0");
    EXPECT_EQ(suggest_name("registry"), "registry-board");
    EXPECT_EQ(suggest_name("\xff\xfe"), "board");
    EXPECT_EQ(suggest_name("/../"), "board");
    for (const auto& text : {std::string(200, 'a'), std::string(200, ' '), std::string("$$$"),
                             std::string("servicebus/"), std::string(63, 'a') + " b"}) {
        EXPECT_TRUE(valid_board_name(suggest_name(text))) << text;
    }
}

TEST(SuggestName, TwoPortsOfOneConverter_HaveTwoNames) {
    const std::string port = "usb-FTDI_Dual_RS232-HS_made_by_somebody_with_a_long_name_FT4ABCDE-if0";
    const auto first = suggest_name(port + "0-port0");
    const auto second = suggest_name(port + "1-port0");
    EXPECT_NE(first, second);
    EXPECT_TRUE(valid_board_name(first)) << first;
    EXPECT_EQ(first, "usb-FTDI_Dua--e_by_somebody_with_a_long_name_FT4ABCDE-if00-port0");
    EXPECT_TRUE(valid_board_name(suggest_name("x" + std::string(5000, '-') + "y")));
    EXPECT_LE(suggest_name(std::string(100, '.')).size(), kMaxNameBytes);
}

TEST(BoardState, EachState_IsFoundByItsText) {
    for (const auto state : {BoardState::kOnline, BoardState::kOffline, BoardState::kLost,
                             BoardState::kSleeping, BoardState::kUpdating}) {
        EXPECT_EQ(board_state_from_text(to_text(state)), state);
    }
    for (const std::string_view text : {"", "Online", "online ", "dead"})
        EXPECT_FALSE(board_state_from_text(text)) << text;
}

}  // namespace
}  // namespace asip::model
