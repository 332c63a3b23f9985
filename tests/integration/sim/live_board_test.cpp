// SPDX-License-Identifier: Apache-2.0
// When a board that runs by the clock runs: the test says what the clock shows.
#include "sim/program/live_board.hpp"

#include <gtest/gtest.h>

#include "sim_program.hpp"
#include "tests/support/temp_dir.hpp"
#include "tty_client.hpp"

namespace asip::test {
namespace {

using namespace std::chrono_literals;

/// A monitor sketch whose port a program has open, and which has said its hello.
class LiveBoardTest : public ::testing::Test {
  protected:
    void SetUp() override {
        auto file = sim::load_board_file(board_file(folder_, "uno.json", R"(,"link":")" + link_ + "\""));
        ASSERT_TRUE(file) << file.error();
        auto board = sim::LiveBoard::create(std::move(*file), reporter_);
        ASSERT_TRUE(board) << board.error();
        board_ = std::move(*board);
        host_.emplace(StreamClient::terminal(link_));
        for (int i = 0; i < 200; ++i)
            tick_after(1ms);
        ASSERT_TRUE(host_->expect("!")) << host_->received();
    }
    sim::Pace tick_after(Duration time) { return board_->tick(now_ += time); }

    TempDir folder_;
    std::string link_ = folder_.file("port");
    sim::Reporter reporter_{sim::Reporter::Format::kText, [](std::string_view) {}};
    std::unique_ptr<sim::LiveBoard> board_;
    std::optional<StreamClient> host_;
    Time now_ = Clock::now();
};

TEST_F(LiveBoardTest, FarBehind_AnswersItsHostOnTheWay) {
    host_->write("Ex");
    auto pace = tick_after(150ms);
    int turns = 1;
    while (host_->received().find('x') == std::string::npos && pace == sim::Pace::kBehind && turns < 1000) {
        pace = tick_after(0ms);
        ++turns;
    }
    EXPECT_NE(host_->received().find('x'), std::string::npos);
    EXPECT_EQ(pace, sim::Pace::kBehind) << "the answer is there long before the board has caught up";
    while (pace == sim::Pace::kBehind && turns < 1000) {
        pace = tick_after(0ms);
        ++turns;
    }
    EXPECT_EQ(pace, sim::Pace::kBusy);
    EXPECT_LT(turns, 100);
}

// Two bytes to the board and one back: 10 bits each, at 57600 baud.
TEST_F(LiveBoardTest, BytesAndTheirAnswer_TakeTheTimeOfTheWire) {
    constexpr auto kWire = std::chrono::microseconds(3 * 10 * 1'000'000 / 57'600);
    for (int i = 0; i < 10; ++i) {
        tick_after(1ms);
        (void)host_->received();
        host_->expect("x", 0ms);
        host_->write("Ex");
        Duration took{};
        tick_after(std::chrono::microseconds(100 * i));  // it came at this moment at the latest
        while (host_->received().find('x') == std::string::npos && took < 10ms) {
            took += 20us;
            tick_after(20us);
        }
        EXPECT_GE(took, kWire) << i;
        EXPECT_LT(took, kWire + 300us) << i;
        ASSERT_TRUE(host_->expect("x", 0ms));
    }
}

TEST_F(LiveBoardTest, NothingOnItsLine_IsIdleUntilAByteOrACommandComes) {
    for (int i = 0; i < 10; ++i)
        tick_after(1ms);
    EXPECT_EQ(tick_after(1ms), sim::Pace::kIdle);
    host_->write("Ex");
    EXPECT_EQ(tick_after(1ms), sim::Pace::kBusy);
    EXPECT_TRUE(wait_until([this] {
        tick_after(1ms);
        return host_->received().find('x') != std::string::npos;
    }));
    for (int i = 0; i < 10; ++i)
        tick_after(1ms);
    EXPECT_EQ(tick_after(1ms), sim::Pace::kIdle);
    EXPECT_TRUE(board_->command("list", "", "", now_));
    EXPECT_EQ(tick_after(1ms), sim::Pace::kBusy) << "who presses a button waits for what it does";
}

TEST_F(LiveBoardTest, WaitsForItsHost_ButNotWhileItHasNoRoomForMoreBytes) {
    std::vector<pollfd> waits;
    const auto ready = [&] {
        waits.clear();
        board_->add_waits(waits);
        return poll(waits.data(), waits.size(), 0);
    };
    EXPECT_EQ(ready(), 0);
    host_->write(std::string(3000, 'E'));
    EXPECT_EQ(ready(), 1);
    for (int i = 0; i < 4; ++i)
        tick_after(0ms);
    EXPECT_EQ(ready(), 0) << "what the board cannot take yet wakes nobody";
    host_.reset();
    tick_after(1ms);
    EXPECT_EQ(ready(), 0) << "nor does a port that nobody has open";
}

}  // namespace
}  // namespace asip::test
