// SPDX-License-Identifier: Apache-2.0
// The display: what can be read on it.
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

class LcdBoard : public FirmwareBoard {
  public:
    explicit LcdBoard(std::vector<sim::PartConfig> more = {})
        : FirmwareBoard("asip_uno_lcd", "uno", parts(std::move(more))) {
        sim().run_for(400ms);  // everything was drawn
    }
    std::string shown() {
        sim().run_for(200ms);
        return sim().part("display").state();
    }

  private:
    static std::vector<sim::PartConfig> parts(std::vector<sim::PartConfig> more) {
        more.push_back({"sh1106", nlohmann::json::object(), "display"});
        return more;
    }
};

TEST(LcdTest, Start_ClearsTheDisplayAndTurnsItOn) {
    LcdBoard board;
    EXPECT_EQ(board.ask("#,N"), "@#,N,2,{I:ASIP core IO,L:LCD}");
    EXPECT_EQ(board.shown(), "blank");
}

TEST(LcdTest, EachLine_IsShownInItsPlace) {
    LcdBoard board;
    for (const char* line : {"L,W,0,Hello, world", "L,W,1,{a|b} ~!", "L,W,2,0123456789 ABCDEFGHIJ",
                             "L,W,3, indented", "L,W,4,abcdefghijklmnopqrstu"})
        EXPECT_EQ(board.ask(line), "") << line;
    EXPECT_EQ(board.shown(),
              "0:Hello, world 1:{a|b} ~! 2:0123456789 ABCDEFGHIJ 3: indented 4:abcdefghijklmnopqrstu");
}

TEST(LcdTest, EveryCharacter_CanBeTold) {
    LcdBoard board;
    for (int first = 33; first < 127; first += 19) {
        std::string text;
        for (int c = first; c < std::min(first + 19, 127); ++c)
            text += static_cast<char>(c);
        board.ask("L,W,1," + text);
        EXPECT_EQ(board.shown(), "1:" + text);
    }
}

TEST(LcdTest, ShorterLine_ClearsTheRestAndLongerOneIsCut) {
    LcdBoard board;
    board.ask("L,W,0,a long line of text");
    board.ask("L,W,0,short");
    EXPECT_EQ(board.shown(), "0:short");
    board.ask("L,W,0,0123456789012345678901234");
    EXPECT_EQ(board.shown(), "0:012345678901234567890");
    board.ask("L,W,0,");
    EXPECT_EQ(board.shown(), "blank");
}

TEST(LcdTest, Bars_AreShownByTheirPercent) {
    LcdBoard board;
    board.ask("L,W,0,text");
    EXPECT_EQ(board.ask("L,G,4,{1:0,2:50,3:33,4:100}"), "");
    EXPECT_EQ(board.shown(), "0:text 1:[0 %] 2:[50 %] 3:[33 %] 4:[100 %]");
    EXPECT_EQ(board.ask("L,W,2,words"), "");
    EXPECT_EQ(board.ask("L,C"), "");
    EXPECT_EQ(board.shown(), "blank");
}

TEST(LcdTest, BadRequest_IsReportedAndChangesNothing) {
    LcdBoard board;
    board.ask("L,W,0,stays");
    EXPECT_EQ(board.ask("L,W,5,x"), "~L,W,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(board.ask("L,W,x,x"), "~L,W,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("L,W,0text"), "~L,W,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("L,W"), "~L,W,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("L,C,1"), "~L,C,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("L,G,2,{0:50,5:1}"), "~L,G,7{INVALID_DEVICE_NUMBER}");
    for (const char* line :
         {"L,G", "L,G,1", "L,G,2,{0:50}", "L,G,1,{0:101}", "L,G,1,{0}", "L,G,1,{0:1", "L,G,1,{0:1}x"})
        EXPECT_EQ(board.ask(line), "~L,G,11{BAD_ARGUMENT}") << line;
    EXPECT_EQ(board.ask("L,x"), "~L,x,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.ask("L,A,5"), "~L,A,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.shown(), "0:stays");
}

TEST(LcdTest, ManyRequestsWhileItDraws_EndWithTheLastText) {
    LcdBoard board;
    for (int i = 0; i < 200; ++i)
        ASSERT_EQ(board.ask("L,W," + std::to_string(i % 5) + ",number " + std::to_string(i)), "");
    EXPECT_EQ(board.shown(), "0:number 195 1:number 196 2:number 197 3:number 198 4:number 199");
}

TEST(LcdTest, LineOnAQuietBus_IsShownWithin42Milliseconds) {
    LcdBoard board;
    board.ask("L,W,1,quick");
    board->run_for(42ms);
    EXPECT_EQ(board->part("display").state(), "1:quick");
}

TEST(LcdTest, DisplayThatIsMissing_IsAnErrorUntilItIsBack) {
    LcdBoard board;
    ASSERT_TRUE(board->part("display").command("detach", ""));
    board.ask("L,W,0,lost");
    board->run_for(20ms);
    EXPECT_EQ(board.ask("L,W,0,x"), "~L,W,8{DEVICE_NOT_AVAILABLE}");
    ASSERT_TRUE(board->part("display").command("attach", ""));
    EXPECT_EQ(board->part("display").state(), "off");
    board.ask("L,C");
    board->run_for(20ms);
    EXPECT_EQ(board.ask("L,W,0,back"), "");
    EXPECT_EQ(board.shown(), "0:back");
}

TEST(LcdTest, StuckBus_IsAnErrorUntilItIsFree) {
    LcdBoard board({{"button", {{"pin", 18}, {"steady", true}}, "short"}});
    ASSERT_TRUE(board->part("short").command("press", ""));
    board.ask("L,W,0,lost");
    board->run_for(50ms);
    EXPECT_EQ(board.ask("L,W,0,x"), "~L,W,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.ask("#,E,here"), "@#,E,here");
    ASSERT_TRUE(board->part("short").command("release", ""));
    board->run_for(50ms);
    board.ask("L,C");
    board->run_for(50ms);
    EXPECT_EQ(board.ask("L,W,0,back"), "");
    EXPECT_EQ(board.shown(), "0:back");
}

// Everything of the bus and a strip of pixels on one board.
TEST(DisplaysTest, SensorsReportWhileTheDisplayAndThePixelsAreDrawn) {
    FirmwareBoard board("asip_uno_displays", "uno",
                        {{"sh1106", nlohmann::json::object(), "display"},
                         {"mpu6050", nlohmann::json::object(), "motion"},
                         {"hmc5883l", nlohmann::json::object(), "compass"},
                         {"bmp085", nlohmann::json::object(), "barometer"},
                         {"pixels", {{"pin", 6}}, "strip"}});
    board.step_up(500000);
    for (const char* request : {"A,A,25", "G,A,25", "H,A,25"})
        EXPECT_EQ(board.ask(request), "");
    int reports = 0, round = 0;
    for (; round < 40; ++round) {
        board->send("L,W," + std::to_string(round % 5) + ",round " + std::to_string(round) + "\nP,S,2,0,{" +
                    std::to_string(round) + ",255}\n");
        for (const auto& line : board.lines_within(25ms)) {
            EXPECT_EQ(line[0], '@') << line;
            ++reports;
        }
    }
    EXPECT_NEAR(reports, 3 * 40, 6);
    board->run_for(300ms);
    EXPECT_EQ(board->part("display").state(), "0:round 35 1:round 36 2:round 37 3:round 38 4:round 39");
    EXPECT_EQ(board->part("strip").state().substr(0, 13), "000027 0000ff");
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
}

}  // namespace
}  // namespace asip::firmware
