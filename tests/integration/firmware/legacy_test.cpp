// SPDX-License-Identifier: Apache-2.0
// Without the extensions a board behaves as a 0.4 board does.
#include <gtest/gtest.h>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

TEST(LegacyTest, Extensions_AreUnknownRequests) {
    FirmwareBoard board("asip_uno_04");
    for (const char tag : {'X', 'E', 'I', 'B', 'C'}) {
        const std::string error = std::string("~#,") + tag + ",2{UNKNOWN_REQUEST}";
        EXPECT_EQ(board.ask(std::string("#,") + tag), error);
        EXPECT_EQ(board.ask(std::string("#,") + tag + ",1"), error);
    }
    EXPECT_EQ(board->board_baud(), 58824u);
}

TEST(LegacyTest, BadArguments_AreUnknownRequestsAndNothingIsDone) {
    FirmwareBoard board("asip_uno_04", "uno", {{"led", {{"pin", 13}}, "lamp"}});
    board.ask("I,P,13,3");
    EXPECT_EQ(board.ask("I,d,13"), "~I,d,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.ask("I,d,13,x"), "~I,d,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.ask("I,d,13,1*7B"), "~I,d,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board->part("lamp").state(), "off");
    EXPECT_EQ(board.ask("I,d,13,1"), "");
    EXPECT_EQ(board->part("lamp").state(), "on");
}

TEST(LegacyTest, RequestsOf04_AreAnsweredAsEver) {
    FirmwareBoard board("asip_uno_04_services");
    EXPECT_EQ(board.banner(), "!AsipServices running on ATmega328P with Services: I D S ");
    EXPECT_EQ(board.ask("#,N"), "@#,N,3,{I:ASIP core IO,D:Distance,S:Servos}");
    EXPECT_EQ(board.ask("I,P,2,2"), "@I,d,4,4");
    EXPECT_EQ(board.ask("Z,z"), "~Z,?,1{INVALID_SERVICE}");
    EXPECT_EQ(board.ask("S,W,9,9"), "~S,W,7{INVALID_DEVICE_NUMBER}");
}

}  // namespace
}  // namespace asip::firmware
