// SPDX-License-Identifier: Apache-2.0
// Stepper motors: where the simulated motors are, and when their steps came.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "firmware_board.hpp"
#include "pulses.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

const sim::PartConfig kDial{"stepper", {{"coils", {8, 9, 10, 11}}}, "dial"};
sim::PartConfig slide(long switch_at = -300) {
    return {"stepper",
            {{"step", 2}, {"direction", 3}, {"enable", 4}, {"switch", 12}, {"switch_at", switch_at}},
            "slide"};
}

class SteppersBoard : public FirmwareBoard {
  public:
    explicit SteppersBoard(const std::string& image = "asip_uno_steppers",
                           std::vector<sim::PartConfig> parts = {kDial, slide()},
                           const std::string& board = "uno")
        : FirmwareBoard(image, board, std::move(parts)) {}

    std::string state(const std::string& part) { return sim().part(part).state(); }
    long position(const std::string& part) { return std::atol(state(part).c_str()); }

    /// The report of a motor that came to rest.
    std::string rest() { return next_line(20s); }
};

/// When the step pin of an A4988 rose, in microseconds.
std::vector<double> steps_of(SteppersBoard& board, int pin) {
    auto times = std::make_shared<std::vector<double>>();
    board->on_pin(pin, [times, &board](sim::Level level) {
        if (level == sim::Level::kHigh) times->push_back(static_cast<double>(board->cycles()) / 16);
    });
    board.rest();
    return *times;
}

TEST(SteppersTest, Service_IsNamedAndOwnsItsPins) {
    SteppersBoard board;
    EXPECT_EQ(board.ask("#,N"), "@#,N,2,{I:ASIP core IO,Y:Steppers}");
    EXPECT_EQ(board.ask("#,S"), "@#,S,20,{@,@,Y,Y,Y,I,I,I,Y,Y,Y,Y,Y,I,I,I,I,I,I,I}");
    EXPECT_EQ(board.ask("Y,M"), "@Y,e,2,{0:0:0,0:0:0}");
}

TEST(SteppersTest, Positions_AreReachedByEachMotor) {
    SteppersBoard board;
    EXPECT_EQ(board.ask("Y,G,0,1000"), "");
    EXPECT_EQ(board.rest(), "@Y,e,2,{1000:0:0,0:0:0}");
    EXPECT_EQ(board.position("dial"), 1000);
    EXPECT_EQ(board.ask("Y,G,1,-250"), "");
    EXPECT_EQ(board.rest(), "@Y,e,2,{1000:0:0,-250:0:0}");
    EXPECT_EQ(board.position("slide"), -250);
    EXPECT_EQ(board.ask("Y,R,0,-1001"), "");
    EXPECT_EQ(board.ask("Y,R,0,-4"), "");
    EXPECT_EQ(board.rest(), "@Y,e,2,{-5:0:0,-250:0:0}");
    EXPECT_EQ(board.position("dial"), -5);
}

TEST(SteppersTest, Speed_GrowsAndFallsByTheAcceleration) {
    SteppersBoard board;
    board.ask("Y,V,1,2000");
    board.ask("Y,C,1,4000");
    board.ask("Y,G,1,1600");
    const auto times = steps_of(board, 2);
    ASSERT_EQ(times.size(), 1600u);
    // 500 steps up, 600 at full speed, 500 down, by half the acceleration times the time squared.
    const auto ms = [&](std::size_t from, std::size_t to) { return (times[to] - times[from]) / 1000; };
    EXPECT_NEAR(ms(0, 499), 1000 * (std::sqrt(2 * 500 / 4000.0) - std::sqrt(2 / 4000.0)), 5);
    EXPECT_NEAR(ms(500, 1099), 599 / 2.0, 1);
    EXPECT_NEAR(ms(1100, 1599), 1000 * std::sqrt(2 * 500 / 4000.0), 10);
    for (std::size_t at = 501; at < 1100; ++at)
        EXPECT_NEAR(times[at] - times[at - 1], 500, 80) << at << ": a tick is 64 us";
}

TEST(SteppersTest, NewPosition_IsTakenOnTheWayAndNoStepIsLostAtATurn) {
    SteppersBoard board;
    for (const char* target : {"900", "300", "310", "-400", "2000", "1500"}) {
        board.ask("Y,G,0," + std::string(target));
        board->run_for(700ms);
    }
    EXPECT_EQ(board.rest(), "@Y,e,2,{1500:0:0,0:0:0}");
    EXPECT_EQ(board.position("dial"), 1500);
}

TEST(SteppersTest, FloodOfRequestsAt1000000Baud_LosesNoStepAndNoByte) {
    SteppersBoard board;
    board.step_up(1000000);
    board.ask("Y,V,0,990");
    board.ask("Y,V,1,4000");
    board.ask("Y,C,1,60000");
    board.ask("Y,A,20");
    board.ask("Y,G,0,3000");
    board.ask("Y,G,1,12000");
    int answers = 0, sent = 0;
    std::string last = "@Y,e,2,{0:1:0,0:1:0}";
    const auto take = [&](std::chrono::milliseconds time) {
        for (const auto& line : board.lines_within(time)) {
            answers += line == "~Z,?,1{INVALID_SERVICE}";
            if (line.substr(0, 4) == "@Y,e") last = line;
        }
    };
    const auto end = board->now() + 6s;
    while (last.find(":1:") != last.npos && board->now() < end) {
        for (int k = 0; k < 8; ++k, ++sent)
            board->send("Z,x\n");
        take(4ms);
    }
    take(100ms);
    EXPECT_GT(sent, 9000);
    EXPECT_EQ(last, "@Y,e,2,{3000:0:0,12000:0:0}");
    EXPECT_EQ(board.position("dial"), 3000);
    EXPECT_EQ(board.position("slide"), 12000);
    EXPECT_EQ(answers, sent);
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
}

TEST(SteppersTest, FasterThanTheMotor_LosesStepsOfTheMotorAlone) {
    SteppersBoard board;
    board.ask("Y,V,0,1500");
    board.ask("Y,G,0,2000");
    EXPECT_EQ(board.rest(), "@Y,e,2,{2000:0:0,0:0:0}");
    EXPECT_LT(board.position("dial"), 1999) << "the part follows its data sheet";
}

TEST(SteppersTest, Stop_IsAtOnceAndTakesOrKeepsThePower) {
    SteppersBoard board;
    EXPECT_EQ(board.state("slide"), "0 on") << "the sketch lets it hold its place";
    EXPECT_EQ(board.state("dial"), "0 off");
    board.ask("Y,G,0,5000");
    board.ask("Y,G,1,5000");
    board->run_for(1s);
    EXPECT_EQ(board.state("dial"), std::to_string(board.position("dial")) + " on");
    const auto stopped = board.ask("Y,S") + board.next_line(20ms);
    const auto dial = std::to_string(board.position("dial")), slide = std::to_string(board.position("slide"));
    EXPECT_NE(stopped.find("@Y,e,2,{" + dial + ":0:0," + slide + ":0:0}"), std::string::npos) << stopped;
    EXPECT_EQ(board.state("dial"), dial + " off");
    EXPECT_EQ(board.state("slide"), slide + " on");
    board->run_for(500ms);
    EXPECT_EQ(board.state("dial"), dial + " off") << "nothing goes on";
    EXPECT_EQ(board.ask("Y,P,0,1"), "");
    EXPECT_EQ(board.ask("Y,P,1,0"), "");
    EXPECT_EQ(board.state("dial"), dial + " on");
    EXPECT_EQ(board.state("slide"), slide + " off");
    board.ask("Y,R,0,8");
    board.ask("Y,R,1,8");
    board->run_for(100ms);
    board.ask("Y,s,0");
    board->run_for(1s);
    EXPECT_EQ(board.state("slide"), std::to_string(std::stol(slide) + 8) + " off")
        << "a moment after its last step";
    EXPECT_EQ(board.state("dial"), std::to_string(board.position("dial")) + " on");
}

TEST(SteppersTest, Home_IsWhereTheSwitchCloses) {
    SteppersBoard board;
    EXPECT_EQ(board.ask("Y,H,1,-2000"), "");
    EXPECT_EQ(board.ask("Y,G,1,5"), "~Y,G,6{WRONG_MODE}");
    EXPECT_EQ(board.ask("Y,H,1,-2000"), "~Y,H,6{WRONG_MODE}");
    EXPECT_EQ(board.rest(), "@Y,e,2,{0:0:0,0:0:1}");
    EXPECT_EQ(board.position("slide"), -300);
    EXPECT_EQ(board.ask("Y,G,1,700"), "");
    EXPECT_EQ(board.rest(), "@Y,e,2,{0:0:0,700:0:1}");
    EXPECT_EQ(board.position("slide"), 400);
    EXPECT_EQ(board.ask("Y,H,1,-100"), "");
    EXPECT_EQ(board.rest(), "@Y,e,2,{0:0:0,600:0:0}") << "not found within that way";
    EXPECT_EQ(board.ask("Y,H,0,-100"), "~Y,H,4{MODE_UNAVAILABLE}") << "the sketch names no switch for it";
}

TEST(SteppersTest, BadRequests_AreReportedAndMoveNothing) {
    SteppersBoard board;
    for (const char* request : {"Y,G,0", "Y,G,0,x", "Y,G,0,100000001", "Y,R,0,1,2", "Y,V,0,0", "Y,V,0,4001",
                                "Y,C,0,0", "Y,P,0,2", "Y,H,1,0", "Y,s", "Y,S,1", "Y,M,1"})
        EXPECT_EQ(board.ask(request), "~Y," + std::string(1, request[2]) + ",11{BAD_ARGUMENT}") << request;
    EXPECT_EQ(board.ask("Y,G,2,10"), "~Y,G,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(board.ask("Y,x,0"), "~Y,x,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.ask("Y,M"), "@Y,e,2,{0:0:0,0:0:0}");
    EXPECT_EQ(board.ask("Y,G,0,10"), "");
    EXPECT_EQ(board.rest(), "@Y,e,2,{10:0:0,0:0:0}");
}

TEST(SteppersTest, Restart_StopsThem) {
    SteppersBoard board;
    board.ask("Y,G,0,5000");
    board->run_for(500ms);
    board.ask("#,R");
    const long stopped = board.position("dial");
    board->run_for(500ms);
    EXPECT_EQ(board.state("dial"), std::to_string(stopped) + " off");
    EXPECT_EQ(board.ask("Y,M"), "@Y,e,2,{0:0:0,0:0:0}");
}

// Servos have the same timer, on a Leonardo the tone too: for that, its image is built, as simavr has no
// third comparison of its timer 1.
TEST(SteppersTest, ServosAndTone_ShareTheTimer) {
    for (const std::string kind : {"uno", "mega"}) {
        SteppersBoard board("asip_" + kind + "_steppers_beside", {kDial}, kind);
        Pulses pulses(board, 5);
        int waves = 0;
        board->on_pin(4, [&](sim::Level level) { waves += level == sim::Level::kHigh; });
        board.ask("S,W,0,45");
        board.ask("T,P,1000,800");
        board.ask("Y,G,0,400");
        EXPECT_EQ(board.rest(), "@Y,e,1,{400:0:0}");
        EXPECT_EQ(board.position("dial"), 400) << kind;
        EXPECT_NEAR(waves, 800, 3) << kind;
        ASSERT_GT(pulses.widths.size(), 20u);
        EXPECT_NEAR(pulses.widths.back(), 544 + 45 * 1856 / 180.0, 15) << kind;
        EXPECT_EQ(board.ask("I,a,9,100"), "~I,a,3{INVALID_PIN}") << kind;
    }
}

}  // namespace
}  // namespace asip::firmware
