// SPDX-License-Identifier: Apache-2.0
// A value that may be one of before: of reports that were turned off, or what another was waiting for.
#include <gtest/gtest.h>

#include "tests/unit/session/board_session_bench.hpp"
#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {
namespace {

// A service that answers at once: nothing comes behind the fence.
class AnswersAtOnce : public EachGeneration {
  protected:
    AnswersAtOnce() {
        EXPECT_TRUE(bench.start(no_step_up()));
        bench.board.replies["D,M"] = "@D,e,1,{7}";
    }
    RequestId measure(Duration deadline = 5s) {
        return bench.request("D,M",
                             {.deadline = bench.now + deadline, .answer_tag = 'e', .answer_time = 500ms});
    }
    void report_for_a_while() {
        bench.request("D,A,100");
        for (int i = 0; i < 5; ++i) {
            bench.pass(100ms);
            bench.say_line("@D,e,1,{1}");
        }
    }
    Ending ending(RequestId id) const { return bench.end_of(id)->ending; }
};
INSTANTIATE_TEST_SUITE_P(Boards, AnswersAtOnce,
                         testing::Values(Generation::kPlain04, Generation::kExtended, Generation::kVerified));

TEST_P(AnswersAtOnce, ReportsWereTurnedOff_ValueComesOnceTheyAreOver) {
    report_for_a_while();
    bench.hold();
    const auto off = bench.request("D,A,0");
    const auto first = measure();
    bench.release();
    EXPECT_EQ(ending(off), Ending::kExecuted);
    bench.pass(200ms);
    bench.say_line("@D,e,1,{2}");  // begun before
    EXPECT_EQ(bench.end_of(first), nullptr) << "a report is not the answer";
    const auto other = bench.request("I,d,13,1", {.client = 9});
    EXPECT_EQ(ending(other), Ending::kExecuted) << "nobody else waits";
    bench.pass(1200ms);
    EXPECT_EQ(bench.answer(first), "@D,e,1,{7}");
    const auto second = measure();
    EXPECT_EQ(bench.answer(second), "@D,e,1,{7}") << "at once";
}

TEST_P(AnswersAtOnce, LevelsWhileAnalogPinsReportAndInputsChange_AreAnsweredAtOnce) {
    bench.board.replies["I,L"] = "@I,L,2,{3:0,4:4}";
    bench.request("I,A,100");
    bench.say_line("@I,a,1,{0:17}");
    bench.say_line("@I,d,4,0");
    bench.hold();
    const auto id = bench.request("I,L", {.answer_tag = 'L'});
    bench.say_line("@I,d,4,4");
    bench.release();
    ASSERT_NE(bench.end_of(id), nullptr);
    EXPECT_EQ(ending(id), Ending::kExecuted);
    EXPECT_EQ(bench.answer(id), "@I,L,2,{3:0,4:4}");
}

TEST_P(AnswersAtOnce, NoTimeToWait_IsAskedAndTheNextIsBelievedAgain) {
    report_for_a_while();
    bench.request("D,A,0");
    for (int i = 0; i < 6; ++i) {
        const auto id = measure(400ms);
        bench.pass(400ms);
        ASSERT_NE(bench.end_of(id), nullptr);
        EXPECT_EQ(ending(id), i < 2 ? Ending::kNoValue : Ending::kExecuted) << i;
    }
}

TEST_P(AnswersAtOnce, ReportsWereTurnedOffBehindTheDeadline_IsKnownOnceTheFenceIsBack) {
    report_for_a_while();
    bench.hold();
    const auto off = bench.request("#,R", {.deadline = bench.now + 50ms});
    bench.pass(60ms);
    EXPECT_EQ(ending(off), Ending::kTimeout);
    bench.release();
    bench.pass(2s);
    const auto value = measure();
    ASSERT_NE(bench.end_of(value), nullptr) << "at once";
    EXPECT_EQ(ending(value), Ending::kExecuted);
}

TEST_P(AnswersAtOnce, OnceTheyTookTimeAndOneWasLost_OneMoreAtMostIsNotBelieved) {
    bench.board.replies["D,M"] = "";
    const auto slow = measure();
    bench.pass(30ms);
    bench.say_line("@D,e,1,{7}");
    EXPECT_EQ(ending(slow), Ending::kExecuted);
    bench.board.lose_lines = 1;
    measure();
    bench.pass(3s);
    bench.board.replies["D,M"] = "@D,e,1,{7}";
    for (int i = 0; i < 5; ++i) {
        const auto id = measure();
        bench.pass(700ms);
        ASSERT_NE(bench.end_of(id), nullptr);
        if (i > 0) {
            EXPECT_EQ(ending(id), Ending::kExecuted) << i;
        }
    }
}

TEST_P(AnswersAtOnce, OneWasLostWithARestart_TheNextIsBelieved) {
    bench.board.mute = true;
    const auto lost = measure();
    bench.board.mute = false;
    bench.say(bench.board.reboot());
    EXPECT_EQ(ending(lost), Ending::kDoubt);
    const auto next = measure();
    bench.pass(600ms);
    ASSERT_NE(bench.end_of(next), nullptr);
    EXPECT_EQ(ending(next), Ending::kExecuted);
}

TEST_P(AnswersAtOnce, ReportsAreRare_TheNextIsWaitedFor) {
    bench.request("D,A,2000");
    bench.pass(1s);
    bench.say_line("@D,e,1,{1}");
    const auto id = measure();
    bench.pass(1900ms);
    EXPECT_EQ(bench.end_of(id), nullptr) << "what came before its fence may be a report";
    bench.say_line("@D,e,1,{8}");
    EXPECT_EQ(bench.answer(id), "@D,e,1,{8}");
}

// A board behind a network on which everything takes up to 400 ms.
TEST(SlowLink, OneWasLost_OneMoreAtMostIsNotBelieved) {
    Bench bench(no_step_up());
    bench.board.replies["D,M"] = "@D,e,1,{7}";
    const auto pass = [&bench](int windows) {
        for (int i = 0; i < windows; ++i) {
            bench.pass(400ms);
            bench.release_held();
        }
    };
    bench.hold();
    bench.plug();
    pass(50);
    ASSERT_EQ(bench.session.state(), BoardSession::State::kReady);
    for (int i = 0; i < 6; ++i) {
        bench.board.lose_lines = i == 0 ? 1 : 0;
        const auto id =
            bench.request("D,M", {.deadline = bench.now + 5s, .answer_tag = 'e', .answer_time = 500ms});
        pass(15);
        ASSERT_NE(bench.end_of(id), nullptr);
        if (i > 1) {
            EXPECT_EQ(bench.ending(id), Ending::kExecuted) << i;
        }
    }
}

}  // namespace
}  // namespace asip::session
