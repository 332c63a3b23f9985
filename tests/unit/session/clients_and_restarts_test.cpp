// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/unit/session/board_session_bench.hpp"
#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

TEST(BoardSession, FloodOfOneClient_AnotherWaitsForOneRequestOnly) {
    ReadyBench bench(no_step_up());
    bench.board.mute = true;
    for (int i = 0; i < 64; ++i)
        bench.request("S,W,0," + std::to_string(i), {.client = 1});
    const auto polite = bench.request("I,d,13,1", {.client = 2});
    EXPECT_NE(polite, 0u);
    bench.board.mute = false;
    bench.board.executed.clear();
    bench.pass(10s);
    const auto& executed = bench.board.executed;
    const auto at = std::find(executed.begin(), executed.end(), "I,d,13,1");
    ASSERT_NE(at, executed.end());
    EXPECT_LE(at - executed.begin(), 1);
}

TEST(BoardSession, DeadlineWhileWaiting_IsNotSentAndNeverWillBe) {
    ReadyBench bench(no_step_up());
    bench.board.mute = true;
    std::vector<RequestId> ids;
    for (int i = 0; i < 10; ++i)
        ids.push_back(bench.request("S,W,0," + std::to_string(i), {.deadline = bench.now + 300ms}));
    bench.pass(300ms);
    EXPECT_EQ(bench.ending(ids.back()), Ending::kNotSent);
    EXPECT_EQ(bench.end_of(ids.back())->not_sent, NotSent::kDeadline);
    EXPECT_EQ(bench.ending(ids.front()), Ending::kTimeout);
    bench.board.mute = false;
    bench.pass(20s);
    EXPECT_THAT(bench.board.executed, Not(Contains("S,W,0,9")));
}

TEST_P(EachGeneration, BannerInMidStream_ModesLevelsAndPeriodsAreRestored) {
    SessionOptions options = no_step_up();
    ASSERT_TRUE(bench.start(options));
    for (const char* line : {"I,P,13,3", "I,d,13,1", "D,A,100", "S,W,0,90", "I,P,12,2"})
        bench.request(line);
    bench.board.executed.clear();
    bench.say(bench.board.reboot());
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_EQ(bench.count("reset"), 1);
    EXPECT_EQ(bench.count("identified"), 2);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,P,12,2", "I,P,13,3", "I,d,13,1", "D,A,100"));
    EXPECT_EQ(bench.session.period('D'), 100u);
}

// The answer is read before the line mends itself: the board is asked again before it is another one.
TEST_P(EachGeneration, AnswerIsDamagedBehindARestart_SettingsAreRestored) {
    ASSERT_TRUE(bench.start(no_step_up()));
    bench.request("I,P,13,3");
    bench.board.executed.clear();
    bench.board.heard.clear();
    bench.board.sketch = "Scrypt";
    bench.hold();
    bench.say("!Script running on ATmega328P with Services: I S D \r\n");
    bench.release_held();
    bench.board.sketch = "Script";
    bench.release();
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_GT(std::count(bench.board.heard.begin(), bench.board.heard.end(), "#,?"), 1);
    EXPECT_EQ(bench.count("identified"), 2);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,P,13,3"));
}

TEST_P(EachGeneration, AnotherSketchBehindARestart_IsBelievedTheSecondTime) {
    ASSERT_TRUE(bench.start(no_step_up()));
    bench.request("I,P,13,3");
    bench.board.executed.clear();
    bench.board.heard.clear();
    bench.board.sketch = "Other";
    bench.say(bench.board.reboot());
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_EQ(std::count(bench.board.heard.begin(), bench.board.heard.end(), "#,?"), 2);
    EXPECT_EQ(bench.session.identity().info.sketch, "Other");
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_P(EachGeneration, BannerCutInHalf_IsStillARestart) {
    ASSERT_TRUE(bench.start(no_step_up()));
    bench.request("I,P,13,3");
    bench.board.executed.clear();
    bench.say("ing on ATmega328P with Services: I S D \r\n");
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_THAT(bench.board.executed, ElementsAre("I,P,13,3"));
}

// The board had accepted that setting before: the line changed it, and may have changed what follows.
TEST_P(EachGeneration, ErrorOfASettingThatIsRestored_PutsWhatIsInFlightInDoubt) {
    ASSERT_TRUE(bench.start(no_step_up()));
    bench.request("I,P,13,3");
    bench.board.replies["I,P,13,3"] = "~I,P,3{INVALID_PIN}";
    bench.board.misreads["S,W,0,2"] = "S,W,0,0";
    bench.board.mute = true;
    bench.say(bench.board.reboot());
    const auto damaged = bench.request("S,W,0,2");
    bench.board.mute = false;
    ASSERT_TRUE(bench.ready_within(5s));
    bench.pass(1s);
    EXPECT_EQ(bench.ending(damaged), Ending::kDoubt);
    EXPECT_EQ(bench.ending(bench.request("S,W,0,3")), Ending::kExecuted);
}

struct RestoredDamaged : testing::Test {
    RestoredDamaged() : bench(no_step_up()) {
        bench.board.verified_fences = true;
        EXPECT_TRUE(bench.start());
        bench.request("I,P,13,3");
        bench.board.misreads["I,P,13,3"] = "I,P,13,1";
        bench.say(bench.board.reboot());
        EXPECT_TRUE(bench.ready_within(1s));
    }
    std::string last_mode() const {
        const auto& executed = bench.board.executed;
        const auto last = std::find_if(executed.rbegin(), executed.rend(),
                                       [](const auto& line) { return line.starts_with("I,P,13,"); });
        return last == executed.rend() ? "" : *last;
    }
    Bench bench;
};

TEST_F(RestoredDamaged, SettingChangedOnTheWay_IsRestoredAgain) {
    EXPECT_EQ(last_mode(), "I,P,13,1");
    bench.board.misreads.clear();
    bench.pass(3s);
    EXPECT_EQ(last_mode(), "I,P,13,3");
}

TEST_F(RestoredDamaged, SetOtherwiseMeanwhile_TheLaterSettingStays) {
    const auto id = bench.request("I,P,13,2");
    bench.board.misreads.clear();
    bench.pass(3s);
    const auto later = bench.request("I,P,13,5");
    bench.pass(3s);
    ASSERT_NE(bench.end_of(id), nullptr);
    EXPECT_EQ(bench.ending(later), Ending::kExecuted);
    EXPECT_EQ(last_mode(), "I,P,13,5");
}

TEST_F(RestoredDamaged, ClientsFloodMeanwhile_AreServedAndItIsRestored) {
    for (int i = 0; i < 40; ++i)
        bench.request("I,d,12," + std::to_string(i % 2), {.client = 1});
    bench.board.misreads.clear();
    bench.pass(3s);
    EXPECT_EQ(last_mode(), "I,P,13,3");
    EXPECT_EQ(bench.session.queued(), 0u);
}

TEST(BoardSession, RestartAtAFastRate_IsNoticedByGarbageAndRestored) {
    ReadyBench bench;
    bench.request("I,P,13,3");
    bench.board.executed.clear();
    bench.board.reboot();
    bench.say("\x80\x91\n");
    bench.pass(5s);
    ASSERT_TRUE(bench.ready_within());
    EXPECT_EQ(bench.session.baud(), 1'000'000u);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,P,13,3"));
}

TEST(BoardSession, RefusedMode_IsNotRestored) {
    Bench bench(no_step_up());
    bench.board.replies["I,P,1,3"] = "~I,P,3{INVALID_PIN}";
    ASSERT_TRUE(bench.start());
    bench.request("I,P,1,3");
    bench.board.executed.clear();
    bench.say(bench.board.reboot());
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST(BoardSession, ClientRestartsTheBoard_NothingIsRestored) {
    ReadyBench bench(no_step_up());
    bench.request("I,P,13,3");
    bench.request("#,R");
    bench.board.executed.clear();
    bench.say(bench.board.reboot());
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST(BoardSession, Replugged_SettingsAreRestored) {
    ReadyBench bench;
    bench.request("I,P,13,3");
    bench.unplug();
    bench.board.reboot();
    bench.board.executed.clear();
    bench.pass(1min);
    bench.plug();
    ASSERT_TRUE(bench.ready_within(3s));
    EXPECT_THAT(bench.board.executed, ElementsAre("I,P,13,3"));
}

TEST(BoardSession, QueuedWhileRestarting_IsExecutedAfterwards) {
    ReadyBench bench(no_step_up());
    bench.request("I,P,13,3");
    bench.board.mute = true;
    bench.say(bench.board.reboot());
    bench.board.executed.clear();
    const auto id = bench.request("I,d,13,1");
    bench.board.mute = false;
    ASSERT_TRUE(bench.ready_within(5s));
    EXPECT_THAT(bench.board.executed, ElementsAre("I,P,13,3", "I,d,13,1"));
    EXPECT_EQ(bench.ending(id), Ending::kExecuted);
}

TEST_P(EachGeneration, QuietBoard_IsProbedAndStaysReady) {
    ASSERT_TRUE(bench.start());
    bench.pass(1min);
    EXPECT_EQ(bench.session.state(), BoardSession::State::kReady);
    EXPECT_EQ(bench.count("silent"), 0);
    EXPECT_GE(bench.board.heard.size(), 20u);
    EXPECT_THAT(bench.lines, IsEmpty());
}

TEST_P(EachGeneration, BoardStopsAnswering_IsSilentWithinFourSecondsAndFoundAgain) {
    ASSERT_TRUE(bench.start());
    bench.board.mute = true;
    bench.pass(4s);
    EXPECT_EQ(bench.count("silent"), 1);
    EXPECT_EQ(bench.session.state(), BoardSession::State::kSilent);
    EXPECT_EQ(bench.refused("I,d,13,1"), Refusal::kNoBoard);
    bench.board.mute = false;
    ASSERT_TRUE(bench.ready_within(5s));
    EXPECT_EQ(bench.count("identified"), 2);
}

TEST_P(EachGeneration, GarbageInManyForms_IsCountedAndTheNextMessageWorks) {
    ASSERT_TRUE(bench.start(no_step_up()));
    const std::string long_line(10'000, 'x');
    for (const std::string& bytes :
         {std::string("\0\xff\x80\n", 4), long_line + "\n", std::string("@\n"), std::string("~I,d,\n"),
          std::string("@I\xfe,d\n"), std::string("nonsense\n")}) {
        const auto before = bench.session.counters().garbage;
        bench.say(bytes);
        EXPECT_EQ(bench.session.counters().garbage, before + 1) << bytes.substr(0, 20);
        bench.pass(1ms);
        bench.lines.clear();
        bench.say_line("@I,d,4,c");
        EXPECT_THAT(bench.lines, ElementsAre("@I,d,4,c"));
    }
}

TEST(BoardSession, NoNewlineForAMinute_BoardIsAskedAndStays) {
    ReadyBench bench(no_step_up());
    bench.say("@I,a,1,{");
    bench.pass(1min);
    ASSERT_TRUE(bench.ready_within(5s));
    const auto id = bench.request("I,d,13,1");
    bench.pass(2s);
    ASSERT_NE(bench.end_of(id), nullptr);
}

}  // namespace
}  // namespace asip::session
