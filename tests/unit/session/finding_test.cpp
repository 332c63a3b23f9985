// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/session/rate_change.hpp"
#include "asip/session/search.hpp"
#include "tests/unit/session/board_session_bench.hpp"
#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(BoardSession, BoardWithExtensions_IsIdentifiedAndSteppedUp) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(1s));
    const Identity& board = bench.session.identity();
    EXPECT_EQ(board.info.chip, "ATmega328P");
    EXPECT_EQ(board.stored_name, "uno1");
    EXPECT_EQ(board.services.size(), 3u);
    EXPECT_EQ(board.pin_owners, "@@IISD");
    EXPECT_EQ(board.port_map.positions().size(), 6u);
    EXPECT_EQ(bench.session.baud(), 1'000'000u);
    EXPECT_EQ(bench.board.baud, 1'000'000u);
    EXPECT_EQ(bench.count("identified"), 1);
    EXPECT_THAT(bench.lines, IsEmpty());
}

TEST_F(OldBoard, IsIdentifiedAndLeftAtItsRate) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_TRUE(bench.session.identity().extensions.empty());
    EXPECT_EQ(bench.session.identity().stored_name, "");
    EXPECT_THAT(bench.rates, IsEmpty());
}

TEST(BoardSession, RestartingBoard_IsNotWrittenToBeforeItsBanner) {
    Bench bench;
    bench.plug({57600, true});
    bench.pass(2s);
    EXPECT_THAT(bench.board.heard, IsEmpty());
    bench.say(bench.board.banner());
    EXPECT_TRUE(bench.ready_within(100ms));
}

TEST(BoardSession, RestartingBoardWithoutBanner_IsAskedAfterTheBootTime) {
    Bench bench;
    bench.plug({57600, true});
    EXPECT_TRUE(bench.ready_within(3s));
}

TEST(BoardSession, BoardLeftAtAFastRate_IsFound) {
    Bench bench;
    bench.board.baud = 500'000;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(3s));
    EXPECT_EQ(bench.board.baud, 1'000'000u);
}

/// When a board at `board_baud` that answers `late` is heard at its rate; Time::max(): not within a minute.
Time heard_at(unsigned start_baud, unsigned board_baud, Duration late) {
    Search search;
    search.start(start_baud, true, 1, Time{}, Time{});
    std::vector<Time> answers;
    for (Time now{}; now < Time{} + 60s; now = search.next_deadline()) {
        const Search::Step step = search.next(now);
        if (step.ask && step.baud == board_baud) answers.push_back(now + late);
        for (const Time answer : answers) {
            if (answer < now || answer >= search.next_deadline()) continue;
            if (step.baud == board_baud) return answer;
            search.bytes_came();
        }
    }
    return Time::max();
}

TEST(Search, BoardThatAnswersLate_IsHeardAtItsRate) {
    for (const unsigned start : {57600u, 115'200u}) {
        EXPECT_EQ(heard_at(start, start, 550ms), Time{} + 550ms);
        EXPECT_LT(heard_at(start, start, 1s), Time{} + 4s);
        EXPECT_LT(heard_at(start, start, 2s), Time{} + 8s);
        EXPECT_LT(heard_at(start, 500'000, 10ms), Time{} + 1s);
        EXPECT_LT(heard_at(start, 500'000, 700ms), Time{} + 10s);
    }
}

TEST(Search, WhereSomethingReadsAsAsip_IsAskedNext) {
    Search search;
    search.start(57600, true, 1, Time{}, Time{});
    Time now{};
    while (search.next(now).baud != 1'000'000)
        now = search.next_deadline();
    search.heard();
    EXPECT_EQ(search.next(search.next_deadline()).baud, 1'000'000u);
    EXPECT_EQ(search.next(search.next_deadline()).baud, 250'000u);
}

// By an agent that was killed.
TEST(BoardSession, ChecksumsAndAFastLineWereLeftOn_BoardIsFoundAtTheFirstQuestionThere) {
    Bench bench;
    bench.board.baud = 1'000'000;
    bench.board.checksum = true;
    bench.plug();
    EXPECT_TRUE(bench.ready_within(1s));
}

// As a board does that reports at the rate to which it was stepped up before.
TEST(Search, PatientOneWhereBytesCome_TriesOtherRatesAgainWithinNineSeconds) {
    Search search;
    search.start(57600, true, 1, Time{}, Time{}, true);
    Time other{};
    for (Time now{}; now < Time{} + 60s; now = search.next_deadline()) {
        if (search.next(now).baud != 57600) other = now;
        search.bytes_came();
        ASSERT_LT(now, other + 9s);
    }
}

/// When a board is asked that goes on only after a second without a byte, whatever it says meanwhile.
Time goes_on_at(bool rates, bool says_something) {
    Search search;
    search.start(57600, rates, 1, Time{}, Time{});
    Time asked{};
    for (Time now{}; now < Time{} + 60s; now = search.next_deadline()) {
        if (search.next(now).baud == 57600 && now >= asked + 1s) return now;
        asked = now;
        if (says_something) search.heard();
    }
    return Time::max();
}

TEST(Search, BoardOf04InACutOffMessage_HasASecondOfSilence) {
    for (const bool says_something : {false, true}) {
        EXPECT_LT(goes_on_at(false, says_something), Time{} + 2s);
        EXPECT_LT(goes_on_at(true, says_something), Time{} + 3s);
    }
}

// As when the answer at the start rate waited in a buffer until the rate had changed, twice.
TEST(BoardSession, LateAnswerReadAtAnotherRate_IsNotTakenForABoardThere) {
    Bench bench(no_step_up());
    bench.board.mute = true;
    bench.plug();
    bench.pass(700ms);
    ASSERT_NE(bench.host_baud, 57600u);
    bench.board.mute = false;
    const auto answer = bench.board.framed("@#,?,0,4,ATmega328P,20,Script");
    bench.say(answer);
    bench.say(answer);
    EXPECT_TRUE(bench.ready_within(5s));
    EXPECT_EQ(bench.host_baud, 57600u);
    EXPECT_EQ(bench.session.identity().services.size(), 3u);
}

TEST(BoardSession, BoardLeftWithChecksums_IsFound) {
    Bench bench(no_step_up());
    bench.board.checksum = true;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(3s));
    EXPECT_FALSE(bench.board.checksum);
}

TEST(BoardSession, NothingAnswers_ReportsItOnceAndKeepsAsking) {
    Bench bench;
    bench.board.mute = true;
    bench.plug();
    bench.pass(30s);
    EXPECT_EQ(bench.count("no-answer"), 1);
    bench.board.mute = false;
    EXPECT_TRUE(bench.ready_within(5s));
}

TEST(BoardSession, RateAfterRateFailsForLong_IsNotCalledNoAnswer) {
    SessionOptions options;
    options.patience = 1s;
    Bench bench(options);
    bench.board.fastest_working = 57600;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(20s));
    EXPECT_GT(bench.now, Time{} + 1s);
    EXPECT_EQ(bench.count("no-answer"), 0);
}

TEST(BoardSession, SlowToSayWhatItIs_IsNotCalledNoAnswer) {
    Bench bench(no_step_up());
    bench.board.replies["#,S"] = "";
    bench.board.replies["I,m"] = "";
    bench.plug();
    ASSERT_TRUE(bench.ready_within(15s));
    EXPECT_GT(bench.now, Time{} + 8s);
    EXPECT_EQ(bench.count("no-answer"), 0);
}

TEST_P(EachGeneration, RestartsAgainAndAgainAndSaysNothingElse_IsSilent) {
    ASSERT_TRUE(bench.start());
    bench.board.mute = true;
    for (int i = 0; i < 10; ++i) {
        bench.say(bench.board.reboot());
        bench.pass(2s);
    }
    EXPECT_EQ(bench.count("silent"), 1);
    EXPECT_EQ(bench.refused("I,d,13,1"), Refusal::kNoBoard);
    bench.board.mute = false;
    EXPECT_TRUE(bench.ready_within(5s));
}

TEST(BoardSession, CallerWasStopped_SilenceMeanwhileSaysNothing) {
    ReadyBench bench(no_step_up());
    bench.board.mute = true;
    bench.request("I,d,13,1", {.prove = false});
    const Time stopped = bench.now;
    bench.now += 20s;
    bench.session.not_watched(stopped, bench.now);
    bench.pass(3900ms);
    EXPECT_EQ(bench.count("silent"), 0);
    bench.pass(200ms);
    EXPECT_EQ(bench.count("silent"), 1);
}

TEST(BoardSession, OneQuestionUnanswered_RestIsKnown) {
    Bench bench(no_step_up());
    bench.board.replies["I,c"] = "";
    bench.plug();
    ASSERT_TRUE(bench.ready_within(10s));
    EXPECT_THAT(bench.session.identity().pin_capabilities, IsEmpty());
    EXPECT_EQ(bench.session.identity().port_map.positions().size(), 6u);
}

TEST(BoardSession, QuestionRefused_IsNotAskedAgain) {
    Bench bench(no_step_up());
    bench.board.replies["#,S"] = "~#,S,2{UNKNOWN_REQUEST}";
    bench.plug();
    ASSERT_TRUE(bench.ready_within(100ms));
    EXPECT_EQ(bench.session.identity().pin_owners, "");
    EXPECT_EQ(std::count(bench.board.heard.begin(), bench.board.heard.end(), "#,S"), 1);
}

TEST(BoardSession, NamesNotAnswered_LettersOfTheBannerServe) {
    Bench bench(no_step_up());
    bench.board.replies["#,N"] = "~#,N,2{UNKNOWN_REQUEST}";
    bench.plug({57600, true});
    bench.say(bench.board.banner());
    ASSERT_TRUE(bench.ready_within(1s));
    ASSERT_EQ(bench.session.identity().services.size(), 3u);
    EXPECT_EQ(bench.session.identity().services[1].id, 'S');
}

TEST(BoardSession, EventsWhileAsking_AreHandedOn) {
    Bench bench;
    bench.board.answers_info = false;
    bench.plug();
    bench.say("@I,a,1,{0:320}\r\n");
    EXPECT_THAT(bench.lines, ElementsAre("@I,a,1,{0:320}"));
}

TEST(BoardSession, FastestRateDoesNotWork_NextIsTaken) {
    Bench bench;
    bench.board.fastest_working = 500'000;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(5s));
    EXPECT_EQ(bench.session.baud(), 500'000u);
    EXPECT_EQ(bench.board.baud, 500'000u);
}

TEST(RateChange, EchoesThatComeSlowly_AreEnough) {
    Time now{};
    std::vector<std::string> lines;
    RateChange change(500'000, "ab", now, lines);
    const auto board_says = [&](char tag, std::string_view body) {
        now += 400ms;
        change.on_deadline(now, lines);
        change.on_event({'#', tag, body}, now, lines);
    };
    change.on_event({'#', 'B', "500000"}, now, lines);
    change.on_rate_set(true, now, lines);
    change.on_event({'#', 'E', "abfirst"}, now, lines);
    for (int i = 100; i < 130; ++i) {
        ASSERT_EQ(change.step(), RateChange::Step::kBurst) << i;
        board_says('E', "abbur" + std::to_string(i));
    }
    EXPECT_EQ(change.step(), RateChange::Step::kDone);
    EXPECT_LE(lines.size(), 32u);
}

TEST(BoardSession, FastestRateRefused_NextIsTakenWithoutSearching) {
    Bench bench;
    bench.board.fastest_allowed = 250'000;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(100ms));
    EXPECT_EQ(bench.session.baud(), 250'000u);
    EXPECT_THAT(bench.rates, ElementsAre(250'000u));
}

TEST(BoardSession, NoFastRateWorks_StaysAtTheStartRate) {
    Bench bench;
    bench.board.fastest_working = 57600;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(20s));
    EXPECT_EQ(bench.session.baud(), 57600u);
}

TEST(BoardSession, PortCannotSetTheRate_StaysAtTheStartRate) {
    Bench bench;
    bench.rate_works = false;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(20s));
    EXPECT_EQ(bench.board.baud, 57600u);
}

TEST(BoardSession, OnTcp_NoRateIsTouched) {
    Bench bench;
    bench.board.baud = 0;
    bench.plug({0, false});
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_THAT(bench.rates, IsEmpty());
}

TEST(BoardSession, GarbageAtAFastRate_GoesToASlowerOne) {
    ReadyBench bench;
    for (int i = 0; i < 3; ++i)
        bench.say("\x81\x82garbage\n");
    ASSERT_TRUE(bench.ready_within(5s));
    EXPECT_EQ(bench.session.baud(), 500'000u);
}

}  // namespace
}  // namespace asip::session
