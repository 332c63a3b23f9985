// SPDX-License-Identifier: Apache-2.0
// What an output is set to after a restart of its board: a relay that switches on low is on where its pin is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/session/board_session_bench.hpp"

namespace asip::session {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

// What the board executes behind its restart.
std::vector<std::string> restart(Bench& bench) {
    bench.board.executed.clear();
    bench.say(bench.board.reboot());
    EXPECT_TRUE(bench.ready_within(1s));
    auto executed = std::exchange(bench.board.executed, {});
    std::erase(executed, "I,p");
    return executed;
}

struct RelayBoard : testing::Test {
    RelayBoard() {
        bench.board.verified_fences = true;
        bench.board.replies["I,p"] = "@I,p,6,{6,6,1,0,1,4}";
        EXPECT_TRUE(bench.start(no_step_up()));
    }
    void set(std::initializer_list<const char*> lines) {
        for (const char* line : lines)
            EXPECT_EQ(bench.ending(bench.request(line)), Ending::kExecuted) << line;
    }
    Bench bench;
};

TEST_F(RelayBoard, HighOutput_IsHighBeforeItDrives) {
    set({"I,P,2,3", "I,d,2,1"});
    EXPECT_THAT(restart(bench), ElementsAre("I,d,2,1", "I,P,2,3", "I,d,2,1"));
}

TEST_F(RelayBoard, UnallocatedOrAnalogPin_IsHighByItsPullUpBeforeItDrives) {
    set({"I,P,3,3", "I,d,3,1", "I,P,5,3", "I,d,5,1"});
    EXPECT_THAT(restart(bench),
                ElementsAre("I,P,3,2", "I,P,3,3", "I,d,3,1", "I,P,5,2", "I,P,5,3", "I,d,5,1"));
}

TEST_F(RelayBoard, LowOutput_IsLow) {
    set({"I,P,2,3", "I,d,2,1", "I,d,2,0"});
    EXPECT_THAT(restart(bench), ElementsAre("I,d,2,0", "I,P,2,3", "I,d,2,0"));
}

TEST_F(RelayBoard, MadeAnOutputOnceMore_StaysHigh) {
    set({"I,P,2,3", "I,d,2,1", "I,P,2,3"});
    EXPECT_THAT(restart(bench), Contains("I,d,2,1"));
}

TEST_F(RelayBoard, OtherModeMeanwhile_EndsTheLevel) {
    set({"I,P,2,3", "I,d,2,1", "I,P,2,1", "I,P,2,3"});
    EXPECT_THAT(restart(bench), ElementsAre("I,P,2,3"));
}

TEST_F(RelayBoard, DutyBehindALevel_TheModeIsRestoredAndNoDuty) {
    set({"I,P,2,3", "I,d,2,1", "I,a,2,100"});
    EXPECT_THAT(restart(bench), ElementsAre("I,P,2,5"));
}

TEST_F(RelayBoard, CommandInDoubt_NoLevelIsRestored) {
    for (const char* command : {"I,d,2,0", "I,d,2,1"}) {
        set({"I,P,2,3", "I,d,2,1"});
        bench.board.mute = true;
        const auto id = bench.request(command);
        bench.board.mute = false;
        const auto lines = restart(bench);
        EXPECT_EQ(bench.ending(id), Ending::kDoubt);
        EXPECT_THAT(lines, ElementsAre("I,P,2,3")) << command;
    }
}

TEST_F(RelayBoard, PerhapsAnotherBoardIsPluggedIn_NothingIsSetThere) {
    set({"I,P,2,3", "I,d,2,1"});
    bench.unplug();
    bench.board.executed.clear();
    bench.plug({.baud = 57600, .perhaps_another_board = true});
    EXPECT_TRUE(bench.ready_within(10s));
    bench.pass(1s);
    EXPECT_THAT(bench.board.executed, Not(Contains(testing::HasSubstr(",2,"))));
}

TEST_F(RelayBoard, ClientRestartsIt_NoLevelIsRestored) {
    set({"I,P,2,3", "I,d,2,1", "#,R"});
    EXPECT_THAT(restart(bench), IsEmpty());
}

TEST_F(RelayBoard, LevelIsLostOnTheWay_IsRestoredAgain) {
    set({"I,P,2,3", "I,d,2,1"});
    bench.board.misreads["I,d,2,1"] = "I,d,4,1";
    restart(bench);
    bench.board.misreads.clear();
    bench.pass(3s);
    EXPECT_THAT(bench.board.executed, Contains("I,d,2,1"));
}

TEST_F(RelayBoard, OutputsAreHeld_AreRestoredWhenTheyAreFree) {
    set({"I,P,2,3", "I,d,2,1", "I,P,4,2", "D,A,100"});
    bench.session.hold_outputs(true);
    EXPECT_THAT(restart(bench), ElementsAre("I,P,4,2", "D,A,100"));
    bench.pass(10s);
    EXPECT_THAT(bench.board.executed, IsEmpty());
    bench.session.hold_outputs(false);
    bench.pass(1s);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,d,2,1", "I,P,2,3", "I,d,2,1", "I,P,4,2", "D,A,100"));
    EXPECT_THAT(restart(bench), Contains("I,d,2,1"));
}

TEST_F(RelayBoard, OutputsAreHeldInTheMidstOfTheRestore_TheRestWaitsUntilTheyAreFree) {
    for (int pin = 2; pin < 21; ++pin)
        set({("I,P," + std::to_string(pin) + ",3").c_str(), ("I,d," + std::to_string(pin) + ",1").c_str()});
    set({"I,P,21,2"});
    bench.board.executed.clear();
    bench.hold();
    bench.say(bench.board.reboot());
    do
        bench.release_held();
    while (bench.session.state() != BoardSession::State::kReady);
    bench.session.hold_outputs(true);
    bench.release();
    bench.pass(10s);
    EXPECT_THAT(bench.board.executed, Not(Contains("I,P,20,3")));
    EXPECT_THAT(bench.board.executed, Contains("I,P,21,2")) << "no output";
    bench.session.hold_outputs(false);
    bench.pass(3s);
    EXPECT_THAT(bench.board.executed, Contains("I,P,20,3"));
}

TEST_F(RelayBoard, OutputsWereHeldWithoutARestart_NothingIsSent) {
    set({"I,P,2,3", "I,d,2,1"});
    bench.board.executed.clear();
    bench.session.hold_outputs(true);
    bench.session.hold_outputs(false);
    bench.pass(1s);
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_F(RelayBoard, IsToBeLowWhileItIsAway_IsNotHighAgain) {
    set({"I,P,2,3", "I,d,2,1"});
    bench.unplug();
    bench.session.will_execute("I,d,2,0");
    bench.board.executed.clear();
    bench.board.reboot();
    ASSERT_TRUE(bench.start());
    EXPECT_THAT(bench.board.executed, Not(Contains("I,d,2,1")));
}

// Forty lines take many turns: what is still to be sent is of before.
TEST_F(RelayBoard, IsToBeLowInTheMidstOfTheRestore_StaysLow) {
    for (int pin = 2; pin < 22; ++pin)
        set({("I,P," + std::to_string(pin) + ",3").c_str(), ("I,d," + std::to_string(pin) + ",1").c_str()});
    bench.board.executed.clear();
    bench.hold();
    bench.say(bench.board.reboot());
    do
        bench.release_held();
    while (bench.session.state() != BoardSession::State::kReady);
    bench.session.will_execute("I,d,21,0");
    bench.request("I,d,21,0", {.urgent = true});
    bench.release();
    bench.pass(3s);
    const auto& lines = bench.board.executed;
    EXPECT_THAT(lines, Contains("I,d,20,1"));
    EXPECT_THAT(lines, Contains("I,d,21,0"));
    EXPECT_THAT(lines, Not(Contains("I,d,21,1")));
}

// ASIP 0.4 sets the pin low by the mode.
TEST_F(OldBoard, HighOutput_IsHighInTheSameWrite) {
    ASSERT_TRUE(bench.start(no_step_up()));
    for (int pin = 2; pin < 8; ++pin) {
        bench.request("I,P," + std::to_string(pin) + ",3");
        bench.request("I,d," + std::to_string(pin) + ",1");
    }
    bench.board.executed.clear();
    bench.board.keeps_writes = true;
    bench.say(bench.board.reboot());
    ASSERT_TRUE(bench.ready_within(5s));
    bench.pass(1s);
    for (int pin = 2; pin < 8; ++pin) {
        const auto mode = "I,P," + std::to_string(pin) + ",3\n",
                   level = "I,d," + std::to_string(pin) + ",1\n";
        EXPECT_TRUE(std::any_of(bench.board.writes.begin(), bench.board.writes.end(), [&](const auto& bytes) {
            return bytes.find(mode + level) != std::string::npos;
        })) << pin;
    }
}

TEST_F(OldBoard, MadeAnOutputOnceMore_IsLow) {
    ASSERT_TRUE(bench.start(no_step_up()));
    for (const char* line : {"I,P,2,3", "I,d,2,1", "I,P,2,3"})
        bench.request(line);
    EXPECT_THAT(restart(bench), ElementsAre("I,P,2,3"));
}

}  // namespace
}  // namespace asip::session
