// SPDX-License-Identifier: Apache-2.0
// Histories that were made up: each kind of violation is seen, and what only looks like one is not.
#include "tests/cluster/judge.hpp"

#include <gmock/gmock.h>

namespace cluster {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Two boards; a fault from 10 s to 11 s, after which all is well at 12 s.
struct JudgeTest : testing::Test {
    History history{.boards = {"one", "two", "gone"},
                    .commands = {},
                    .executions = {},
                    .gaps = {},
                    .rounds = {{.name = "broker kill",
                                .begin = 10'000,
                                .end = 11'000,
                                .commands_work = 11'400,
                                .catalogues_agree = 12'000,
                                .looked_until = 14'000}},
                    .exits = {},
                    .ended = 60'000};

    void command(Millis sent, Outcome outcome, std::optional<Millis> answered, std::vector<Millis> executed) {
        for (const auto at : executed)
            history.executions.push_back({history.commands.size(), 0, at});
        history.commands.push_back({.board = 0, .sent = sent, .answered = answered, .outcome = outcome});
    }
    Verdict judged() const { return judge(history, pace); }
    std::vector<std::string> violations() const { return judged().violations; }

    /// Wake-ups, `slower` times as slow as on a quiet machine.
    static truth::Pace woken(Millis until, double slower) {
        truth::Pace pace(time_of(0));
        for (auto at = time_of(0); at < time_of(until);) {
            const auto due = at + truth::Pace::kSleep;
            at = due + std::chrono::duration_cast<asip::Duration>(
                           (truth::Pace::kWork + truth::Pace::kLateness) * slower);
            pace.woke(due, at);
        }
        return pace;
    }
    truth::Pace pace = woken(60'000, 1);
};

TEST_F(JudgeTest, AllWell_TableHasTimesAndCountsOfTheFaultAndOfThePauses) {
    command(1000, Outcome::kOk, 1010, {1005});
    command(10'500, Outcome::kUnanswered, std::nullopt, {});
    command(11'500, Outcome::kRefused, 11'510, {});
    command(12'500, Outcome::kOk, 12'510, {12'505});
    const auto verdict = judged();
    EXPECT_THAT(verdict.violations, IsEmpty());
    ASSERT_EQ(verdict.rows.size(), 2u);
    EXPECT_EQ(verdict.rows[0].fault, "broker kill");
    EXPECT_EQ(verdict.rows[0].commands_work, 400);
    EXPECT_EQ(verdict.rows[0].catalogues_agree, 1000);
    EXPECT_THAT(verdict.rows[0].answers, ElementsAre(0, 0, 0, 1, 1));
    EXPECT_THAT(verdict.rows[1].answers, ElementsAre(2, 0, 0, 0, 0));
    EXPECT_THAT(report("mosquitto", verdict), HasSubstr("broker kill"));
}

TEST_F(JudgeTest, OkAndNotExecuted) {
    command(10'500, Outcome::kOk, 10'600, {});
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("(ok) was not executed")));
}

TEST_F(JudgeTest, ExecutedTwice_WhateverTheAnswer) {
    command(10'500, Outcome::kOk, 10'600, {10'520, 10'530});
    command(10'500, Outcome::kUnanswered, std::nullopt, {10'520, 10'530});
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("executed 2 times"), HasSubstr("executed 2 times")));
}

TEST_F(JudgeTest, RefusedAndExecuted) {
    command(10'500, Outcome::kRefused, 10'600, {10'520});
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("(refused) was executed")));
}

TEST_F(JudgeTest, TimeoutMayBeExecutedBeforeItsAnswerAndNotBehindIt) {
    command(10'500, Outcome::kTimeout, 12'500, {12'000});
    EXPECT_THAT(violations(), IsEmpty());
    command(10'500, Outcome::kTimeout, 12'500, {13'200});
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("executed 700 ms after its answer")));
}

TEST_F(JudgeTest, ExecutedAfterItsDeadline_OnlyABrokerThatWasHeldIsAnExcuse) {
    command(10'500, Outcome::kUnanswered, std::nullopt, {18'000});
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("executed 7500 ms after it was sent")));
    history.rounds[0].messages_held = true;
    const auto verdict = judged();
    EXPECT_THAT(verdict.violations, IsEmpty());
    EXPECT_EQ(verdict.rows[0].late_and_held, 1u);
}

TEST_F(JudgeTest, NoAnswer_IsAViolationWhereNothingWasDisturbed) {
    command(1000, Outcome::kUnanswered, std::nullopt, {});
    command(5000, Outcome::kUnanswered, std::nullopt, {});  // the fault begins within its deadline
    command(11'800, Outcome::kUnanswered, std::nullopt, {});
    command(58'000, Outcome::kUnanswered, std::nullopt, {});  // the end came first
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("command 0 to one (unanswered) has no answer")));
}

TEST_F(JudgeTest, TwoAnswersThatDiffer) {
    command(1000, Outcome::kOk, 1010, {1005});
    history.commands.back().differing = true;
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("answered again")));
}

TEST_F(JudgeTest, ErrorOfTheBoardOnACommandThatItKnows) {
    command(1000, Outcome::kError, 1010, {});
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("is one that the board knows")));
}

TEST_F(JudgeTest, CataloguesTooLateOrNever_SayWhichBoards) {
    history.rounds[0].catalogues_agree = 21'001;
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("within 10000 ms")));
    history.rounds[0].catalogues_agree.reset();
    history.rounds[0].wrong["r1"] = {.ghosts = {"gone"}, .lost = {"two"}};
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("r1: gone is a ghost two lives and is not online")));
    EXPECT_EQ(judged().rows[0].catalogues_agree, std::nullopt);
}

TEST_F(JudgeTest, EngineThatWasSlowToComeBack_TheTimeCountsFromThen) {
    history.rounds[0].catalogues_agree = 28'000;
    history.rounds[0].commands_work = 28'000;
    EXPECT_EQ(violations().size(), 2u);
    history.rounds[0].engine_works = 19'000;
    EXPECT_THAT(violations(), IsEmpty());
    EXPECT_EQ(judged().rows[0].engine_works, 8000);
}

TEST_F(JudgeTest, TooLateOnAStarvedMachine_OnlyWhereTheProgramsHadTheTime) {
    pace = woken(300'000, 4);
    auto& round = history.rounds[0];
    round.catalogues_agree = round.commands_work = 50'000;
    EXPECT_THAT(violations(), IsEmpty());
    EXPECT_EQ(judged().starved, 2u);
    EXPECT_THAT(report("mosquitto", judged()), HasSubstr("2 times something was late on a starved machine"));
    round.catalogues_agree.reset();
    round.looked_until = 250'000;
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("catalogues did not agree")));
}

TEST_F(JudgeTest, CommandOnAStarvedMachine_MayBeLateByATimeThatTheProgramsDidNotHave) {
    pace = woken(60'000, 4);
    command(1000, Outcome::kUnanswered, std::nullopt, {8500});
    command(1000, Outcome::kOk, 2000, {3000});
    EXPECT_THAT(violations(), IsEmpty());
    EXPECT_EQ(judged().starved, 3u);
    command(1000, Outcome::kTimeout, 6000, {12'000});
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("was executed 11000 ms after it was sent")));
    command(1000, Outcome::kOk, 2000, {6900});
    EXPECT_THAT(violations(), testing::Contains(HasSubstr("executed 4900 ms after its answer")));
}

TEST_F(JudgeTest, CommandsTooLateOrNever) {
    history.rounds[0].commands_work.reset();
    history.rounds[0].mute = {1};
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("commands did not work again within 10000 ms: two")));
}

TEST_F(JudgeTest, TwoRoundsOfOneFault_TheLongerTimeCountsAndNeverStaysNever) {
    history.rounds.push_back(history.rounds[0]);
    history.rounds[1].begin = 20'000;
    history.rounds[1].end = 21'000;
    history.rounds[1].commands_work = 21'100;
    history.rounds[1].catalogues_agree = 24'000;
    const auto verdict = judged();
    ASSERT_EQ(verdict.rows.size(), 1u);
    EXPECT_EQ(verdict.rows[0].commands_work, 400);
    EXPECT_EQ(verdict.rows[0].catalogues_agree, 3000);
    history.rounds[0].catalogues_agree.reset();
    EXPECT_EQ(judged().rows[0].catalogues_agree, std::nullopt);
}

TEST_F(JudgeTest, GapInEventsAndProgramThatEnded) {
    history.gaps.push_back({.registry = "r1", .after = 4, .next = 6, .at = 100});
    history.exits.emplace_back("agent 3 ended by itself with status 6");
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("event 6 came after 4"), HasSubstr("status 6")));
}

TEST_F(JudgeTest, GapInEventsWhileNodesWereApart_IsCounted) {
    history.gaps.push_back({.registry = "r1", .after = 4, .next = 6, .since = 8000, .at = 13'000});
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("event 6 came after 4"))) << "the engine is one node";
    history.rounds[0].nodes_apart = true;
    EXPECT_THAT(violations(), IsEmpty());
    EXPECT_EQ(judged().excused_gaps, 1u);
    history.gaps.push_back({.registry = "r1", .after = 7, .next = 9, .since = 13'100, .at = 14'000});
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("event 9 came after 7"))) << "the fault was over";
}

TEST_F(JudgeTest, TokenThatNobodySent) {
    history.executions.push_back({17, 0, 100});
    EXPECT_THAT(violations(), ElementsAre(HasSubstr("token 17")));
}

}  // namespace
}  // namespace cluster
