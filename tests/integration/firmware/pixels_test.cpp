// SPDX-License-Identifier: Apache-2.0
// Pixels: what a strip reads from the waveform on its pin.
#include <gtest/gtest.h>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

constexpr int kCount = 18;

class PixelBoard : public FirmwareBoard {
  public:
    explicit PixelBoard(const std::string& image = "asip_uno_pixels", const std::string& kind = "uno",
                        std::uint32_t frequency = 16'000'000)
        : FirmwareBoard(image, kind, {{"pixels", {{"pin", 6}, {"count", kCount}}, "strip"}}, frequency) {}

    /// What the strip shows once everything was sent.
    std::string shown() {
        sim().run_for(3ms);
        return sim().part("strip").state();
    }
};

std::string strip_of(const std::vector<std::string>& first) {
    std::string text;
    for (std::size_t i = 0; i < kCount; ++i)
        text += (i == 0 ? "" : " ") + (i < first.size() ? first[i] : "000000");
    return text;
}

/// P,S with 18 colors of eight digits.
std::string longest_request(int color) {
    std::string line = "P,S,18,0,{";
    for (int i = 0; i < kCount; ++i)
        line += (i == 0 ? "" : ",") + std::to_string(color - i);
    return line + "}";
}

TEST(PixelsTest, Board_NamesTheServiceAndTheLengthOfItsRequests) {
    PixelBoard board;
    EXPECT_EQ(board.ask("#,N"), "@#,N,2,{I:ASIP core IO,P:Pixels}");
    EXPECT_EQ(board.ask("#,X"), "@#,X,8,{L:172,E:1,I:1,B:1,C:1,V:1,D:1,F:2}");
    EXPECT_EQ(board.ask("P,I"), "@P,I,18");
    EXPECT_EQ(board.shown(), strip_of({}));
}

TEST(PixelsTest, Colors_AreShownInTheirOrder) {
    PixelBoard board;
    EXPECT_EQ(board.ask("P,P,2,{0:16711680,2:255}"), "");
    EXPECT_EQ(board.shown(), strip_of({"ff0000", "000000", "0000ff"}));
    EXPECT_EQ(board.ask("P,S,2,1,{65280, 1193046}"), "");
    EXPECT_EQ(board.shown(), strip_of({"ff0000", "00ff00", "123456"}));
}

TEST(PixelsTest, RequestOf172Characters_SetsAllPixels) {
    PixelBoard board;
    const auto line = longest_request(16777215);
    ASSERT_EQ(line.size(), 172u);
    EXPECT_EQ(board.ask(line), "");
    const auto shown = board.shown();
    EXPECT_EQ(shown.substr(0, 13), "ffffff fffffe");
    EXPECT_EQ(shown.substr(shown.size() - 6), "ffffee");
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
}

TEST(PixelsTest, Brightness_ScalesWhatIsShownAndKeepsTheColors) {
    PixelBoard board;
    board.ask("P,S,1,0,{16744448}");
    board.ask("P,B,127");
    EXPECT_EQ(board.shown(), strip_of({"7f4000"}));
    board.ask("P,B,0");
    EXPECT_EQ(board.shown(), strip_of({}));
    board.ask("P,B,255");
    EXPECT_EQ(board.shown(), strip_of({"ff8000"}));
}

TEST(PixelsTest, BadRequest_IsReportedAndChangesNothing) {
    PixelBoard board;
    board.ask("P,S,1,0,{255}");
    for (const char* line :
         {"P,P", "P,P,1", "P,P,1,{0}", "P,P,1,{0:255", "P,P,2,{0:1}", "P,P,1,{1:1}x", "P,P,1,{1:16777216}",
          "P,P,2,{1:1,x:1}", "P,P,0,{}", "P,S,2,0,{1}", "P,S,1,0,{1,2}", "P,S,1,{1}",
          "P,S,2,0,{1,99999999999}", "P,B", "P,B,x", "P,I,1"})
        EXPECT_TRUE(board.ask(line).ends_with(",11{BAD_ARGUMENT}")) << line;
    EXPECT_EQ(board.ask("P,P,2,{1:1,18:1}"), "~P,P,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(board.ask("P,S,2,17,{1,2}"), "~P,S,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(board.ask("P,S,1,65535,{1}"), "~P,S,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(board.ask("P,A,100"), "~P,A,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.shown(), strip_of({"0000ff"}));
    EXPECT_EQ(board.ask("P,S,1,0,{256}"), "");
    EXPECT_EQ(board.shown(), strip_of({"000100"}));
}

TEST(PixelsTest, Restart_MakesThePixelsDark) {
    PixelBoard board;
    board.ask("P,S,1,0,{255}");
    board.ask("P,B,9");
    board.ask("#,R");
    EXPECT_EQ(board.shown(), strip_of({}));
    board.ask("P,S,1,0,{255}");
    EXPECT_EQ(board.shown(), strip_of({"0000ff"}));
}

// Requests come without a pause while the strip is sent again and again.
class PixelsAtRateTest : public testing::TestWithParam<unsigned> {};

TEST_P(PixelsAtRateTest, EndlessRequestsWhileShowing_LoseNoByteAndDamageNoColor) {
    PixelBoard board;
    if (GetParam() != 57600) board.step_up(GetParam());
    std::size_t faults = 0, shows = 0;
    board->on_change([&](const sim::Change& change) {
        ++shows;
        faults += change.value.size() != strip_of({}).size();
    });
    // No more at a time than a receive buffer holds; the next as soon as they are answered.
    for (int round = 0; round < 200; ++round) {
        const auto color = std::to_string(round + 1);
        board->send("P,S,2,16,{" + color + "," + color + "}\n#,E,a\n#,E,b\nZ,x\n#,E,c\n");
        for (const char* answer : {"@#,E,a", "@#,E,b", "~Z,?,1{INVALID_SERVICE}", "@#,E,c"})
            ASSERT_EQ(board.next_line(), answer) << round;
    }
    EXPECT_EQ(faults, 0u);
    EXPECT_GE(shows, 100u);
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
    EXPECT_EQ(board.shown().substr(16 * 7), "0000c8 0000c8");
}

INSTANTIATE_TEST_SUITE_P(All, PixelsAtRateTest, testing::Values(57600u, 500000u, 1000000u));

TEST(PixelsTest, LongestRequestsInARowAt500000_AreAllTaken) {
    PixelBoard board;
    board.step_up(500000);
    for (int round = 0; round < 50; ++round)
        EXPECT_EQ(board.ask(longest_request(16777215 - round)), "");
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
    EXPECT_EQ(board.shown().substr(0, 6), "ffffce");
}

struct PixelKind {
    const char* image;
    const char* board;
    std::uint32_t frequency;
};
void PrintTo(const PixelKind& kind, std::ostream* out) {
    *out << kind.image;
}

class PixelBoardsTest : public testing::TestWithParam<PixelKind> {};

TEST_P(PixelBoardsTest, Waveform_IsThatOfTheDataSheet) {
    const auto& kind = GetParam();
    PixelBoard board(kind.image, kind.board, kind.frequency);
    board.ask("P,S,3,0,{11163050,5592405,16711935}");
    EXPECT_EQ(board.shown(), strip_of({"aa55aa", "555555", "ff00ff"}));
}

INSTANTIATE_TEST_SUITE_P(All, PixelBoardsTest,
                         testing::Values(PixelKind{"asip_mini8_pixels", "nano", 8'000'000},
                                         PixelKind{"asip_mega_pixels", "mega", 16'000'000},
                                         PixelKind{"asip_leonardo_pixels", "leonardo", 16'000'000}),
                         [](const auto& chosen) { return std::string(chosen.param.image); });

TEST(NeoPixelsTest, Pixels_AreShownWhenAskedFor) {
    FirmwareBoard board(
        "asip_uno_neopixels", "uno",
        {{"pixels", {{"pin", 5}, {"count", 2}}, "left"}, {"pixels", {{"pin", 6}, {"count", 2}}, "right"}});
    EXPECT_EQ(board.ask("#,N"), "@#,N,2,{I:ASIP core IO,N:NeoPixels}");
    EXPECT_EQ(board.ask("N,C,1,1,255,128,0"), "");
    board->run_for(3ms);
    EXPECT_EQ(board->part("right").state(), "000000 000000");
    EXPECT_EQ(board.ask("N,S,1"), "");
    board->run_for(3ms);
    EXPECT_EQ(board->part("right").state(), "000000 ff8000");
    EXPECT_EQ(board->part("left").state(), "000000 000000");
    EXPECT_EQ(board.ask("N,B,1,127"), "");
    EXPECT_EQ(board.ask("N,S,1"), "");
    board->run_for(3ms);
    EXPECT_EQ(board->part("right").state(), "000000 7f4000");
}

TEST(NeoPixelsTest, BadRequest_IsReportedAndChangesNothing) {
    FirmwareBoard board("asip_uno_neopixels", "uno", {{"pixels", {{"pin", 5}, {"count", 8}}, "left"}});
    EXPECT_EQ(board.ask("N,C,2,0,1,1,1"), "~N,C,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(board.ask("N,C,0,8,1,1,1"), "~N,C,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(board.ask("N,C,0,0,1,1"), "~N,C,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("N,C,0,0,256,1,1"), "~N,C,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("N,S"), "~N,S,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("N,B,0"), "~N,B,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("N,x,0"), "~N,x,2{UNKNOWN_REQUEST}");
    board.ask("N,S,0");
    board->run_for(3ms);
    EXPECT_EQ(board->part("left").state(), "000000 000000 000000 000000 000000 000000 000000 000000");
}

}  // namespace
}  // namespace asip::firmware
