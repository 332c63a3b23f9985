// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "asip/session/fences.hpp"
#include "tests/unit/session/board_session_bench.hpp"
#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

INSTANTIATE_TEST_SUITE_P(Boards, EachGeneration,
                         testing::Values(Generation::kPlain04, Generation::kExtended, Generation::kVerified),
                         [](const auto& tested) -> std::string {
                             if (tested.param == Generation::kPlain04) return "Plain04";
                             return tested.param == Generation::kVerified ? "Verified" : "Extended";
                         });

TEST(BoardSession, Request_EndsExecutedWhenItsFenceIsBack) {
    ReadyBench bench;
    const auto id = bench.request("I,d,13,1\n");
    EXPECT_EQ(bench.ending(id), Ending::kExecuted);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,d,13,1"));
    EXPECT_EQ(bench.session.bytes_in_flight(), 0u);
}

TEST_F(OldBoard, Request_IsProvenByTheInformationRequest) {
    ASSERT_TRUE(bench.start());
    const auto id = bench.request("I,d,13,1");
    EXPECT_EQ(bench.ending(id), Ending::kExecuted);
    EXPECT_EQ(bench.board.heard.back(), "#,?");
    EXPECT_THAT(bench.lines, IsEmpty());
}

TEST(BoardSession, BoardError_EndsTheRequestAndIsHandedOn) {
    Bench bench;
    bench.board.replies["S,W,9,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    ASSERT_TRUE(bench.start());
    const auto id = bench.request("S,W,9,90");
    EXPECT_EQ(bench.ending(id), Ending::kBoardError);
    EXPECT_EQ(bench.end_of(id)->code, 7);
    EXPECT_EQ(bench.end_of(id)->text, "INVALID_DEVICE_NUMBER");
    EXPECT_THAT(bench.lines, ElementsAre("~S,W,7{INVALID_DEVICE_NUMBER}"));
    EXPECT_EQ(bench.finished.size(), 1u);
}

TEST_P(EachGeneration, AlikeRequestsAtOnce_EachEndsWithItsOwnOutcome) {
    bench.board.replies["S,W,9,1"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    ASSERT_TRUE(bench.start());
    std::vector<RequestId> good, bad;
    bench.board.mute = true;  // they pile up
    for (int i = 0; i < 50; ++i) {
        bad.push_back(bench.request("S,W,9,1", {.client = 1}));
        good.push_back(bench.request("S,W,0,1", {.client = 2}));
    }
    bench.board.mute = false;
    bench.pass(1ms);
    bench.say("");
    // What was swallowed while mute times out; everything else ends as the board says.
    bench.pass(10s);
    int timeouts = 0;
    for (int i = 0; i < 50; ++i) {
        ASSERT_NE(bench.end_of(bad[i]), nullptr);
        ASSERT_NE(bench.end_of(good[i]), nullptr);
        timeouts += bench.ending(bad[i]) != Ending::kExecuted && bench.ending(bad[i]) != Ending::kBoardError;
        if (bench.ending(bad[i]) == Ending::kExecuted) ADD_FAILURE() << "bad request " << i << " proven";
        if (bench.ending(good[i]) == Ending::kBoardError) ADD_FAILURE() << "good request " << i << " refused";
    }
    EXPECT_GE(timeouts, 1);
    EXPECT_EQ(bench.finished.size(), 100u);
    EXPECT_LE(bench.most_in_flight, BoardSession::kReceiveBufferBytes);
}

TEST_P(EachGeneration, UnprovenRequestsOfTwoClientsLookAlike_ErrorGoesToItsOwnAlone) {
    bench.board.replies["S,W,9,1"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    ASSERT_TRUE(bench.start());
    bench.owned_lines.clear();
    for (int i = 0; i < 20; ++i) {
        bench.hold();
        const auto first = bench.request("S,W,0,1", {.client = 1, .prove = false});
        bench.request("S,W,9,1", {.client = 2, .prove = false});
        const auto last = bench.request("S,W,0,2", {.client = 1, .prove = false});
        bench.release();
        bench.pass(300ms);
        for (const auto good : {first, last}) {
            EXPECT_EQ(bench.ending(good), Ending::kUnproven) << i;
        }
    }
    ASSERT_EQ(bench.owned_lines.size(), 20u);
    for (const auto& [line, owner] : bench.owned_lines)
        EXPECT_EQ(owner, ClientId{2}) << line;
}

TEST_P(EachGeneration, ThousandRequestsOfManyClients_NeverMoreThanTheBufferInFlight) {
    ASSERT_TRUE(bench.start());
    for (int i = 0; i < 1000; ++i)
        bench.request(i % 3 ? "I,d,13,1" : "S,W,0,90", {.client = ClientId(i / 60), .prove = i % 2 == 0});
    bench.pass(5s);
    EXPECT_EQ(bench.finished.size(), 1000u);
    EXPECT_LE(bench.most_in_flight, BoardSession::kReceiveBufferBytes);
    EXPECT_EQ(bench.board.executed.size(), 1000u);
}

TEST_P(EachGeneration, RequestsThatBelongTogether_AnotherClientsForTheServiceWaitAndItsOthersDoNot) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.hold();
    for (int i = 0; i < 30; ++i)
        bench.request("I,d,12,1", {.client = 3});
    bench.request("S,W,9,9", {.client = 2});
    for (int i = 0; i < 10; ++i)
        bench.request("S,W,0," + std::to_string(i), {.client = 1, .more_follow = i < 9});
    for (int i = 0; i < 10; ++i)
        bench.request(i % 2 ? "I,d,13,1" : "S,W,9,9", {.client = 2});
    bench.release();
    bench.pass(5s);
    const auto& all = bench.board.executed;
    ASSERT_EQ(all.size(), 51u);
    const auto first = std::find(all.begin(), all.end(), "S,W,0,0");
    const auto last = std::find(all.begin(), all.end(), "S,W,0,9");
    ASSERT_NE(last, all.end());
    EXPECT_EQ(std::count(first, last, "S,W,9,9"), 0);
    EXPECT_GT(std::count(first, last, "I,d,12,1"), 0) << "other services go on";
}

TEST_P(EachGeneration, RowsForTwoServices_KeepTogetherEach) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.hold();
    for (int i = 0; i < 10; ++i) {
        bench.request("S,W,0," + std::to_string(i), {.client = 1, .more_follow = i < 9});
        bench.request("I,d,11," + std::to_string(i % 2), {.client = 4, .more_follow = i < 9});
        bench.request("S,W,9,9", {.client = 2});
        bench.request("I,d,12,1", {.client = 3});
    }
    bench.release();
    bench.pass(5s);
    const auto& all = bench.board.executed;
    ASSERT_EQ(all.size(), 40u);
    const auto ends = [&](const std::string& first, const std::string& last) {
        return std::pair(std::find(all.begin(), all.end(), first),
                         std::find(all.rbegin(), all.rend(), last).base());
    };
    const auto servo = ends("S,W,0,0", "S,W,0,9");
    EXPECT_EQ(std::count(servo.first, servo.second, "S,W,9,9"), 0);
    const auto pins = ends("I,d,11,0", "I,d,11,1");
    EXPECT_EQ(std::count(pins.first, pins.second, "I,d,12,1"), 0);
}

TEST_P(EachGeneration, RequestThatWasToFollow_NeverComes_OthersGoOnAtTheDeadline) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.request("S,W,0,1", {.client = 1, .deadline = bench.now + 300ms, .more_follow = true});
    bench.pass(100ms);
    const auto other = bench.request("S,W,9,9", {.client = 2});
    bench.pass(100ms);
    EXPECT_EQ(bench.end_of(other), nullptr);
    bench.pass(2s);
    EXPECT_EQ(bench.ending(other), Ending::kExecuted);
}

TEST_P(EachGeneration, FenceLost_RequestIsInDoubtAndTheNextWorks) {
    ASSERT_TRUE(bench.start());
    bench.board.swallow_fences = 1;
    const auto lost = bench.request("I,d,13,1");
    bench.say_line("@I,a,1,{0:1}");
    bench.pass(1s);
    bench.say_line("@I,a,1,{0:1}");
    bench.pass(1s);
    EXPECT_EQ(bench.ending(lost), Ending::kDoubt);
    const auto next = bench.request("I,d,13,0");
    EXPECT_EQ(bench.ending(next), Ending::kExecuted);
    EXPECT_EQ(bench.count("silent"), 0);
}

TEST_P(EachGeneration, UnprovenRequests_CostNoFenceEach) {
    ASSERT_TRUE(bench.start());
    bench.request("#,?");  // from now on its digest is known, where it has one
    bench.board.heard.clear();
    bench.request("I,d,13,1", {.prove = false});
    bench.request("I,d,13,0", {.prove = false});
    EXPECT_THAT(bench.board.heard, ElementsAre("I,d,13,1", "I,d,13,0"));
    bench.pass(200ms);
    EXPECT_EQ(bench.board.heard.size(), 3u) << "one fence when nothing else is to do";
    EXPECT_EQ(bench.finished.size(), 3u);
    EXPECT_EQ(bench.session.bytes_in_flight(), 0u);
}

TEST_P(EachGeneration, ClientAsksForInformation_GetsTheAnswer) {
    ASSERT_TRUE(bench.start());
    const auto id = bench.request("#,?", {.prove = true, .answer_tag = '?'});
    EXPECT_EQ(bench.ending(id), Ending::kExecuted);
    EXPECT_EQ(bench.answer(id), "@#,?,0,4,ATmega328P,6,Script");
    EXPECT_THAT(bench.lines, ElementsAre("@#,?,0,4,ATmega328P,6,Script"));
}

TEST(BoardSession, ClientSendsAFence_GetsItsOwnAnswerOnly) {
    ReadyBench bench;
    const auto id = bench.request("#,E,mine");
    EXPECT_THAT(bench.lines, ElementsAre("@#,E,mine"));
    EXPECT_EQ(bench.ending(id), Ending::kExecuted);
}

TEST(BoardSession, AnswerEvent_ComesWithTheEnd) {
    Bench bench;
    bench.board.replies["D,M"] = "@D,e,2,{42,118}";
    ASSERT_TRUE(bench.start());
    const auto id = bench.request("D,M", {.prove = true, .answer_tag = 'e'});
    EXPECT_EQ(bench.answer(id), "@D,e,2,{42,118}");
    EXPECT_THAT(bench.lines, ElementsAre("@D,e,2,{42,118}"));
}

TEST(BoardSession, ServiceTheBoardDoesNotHave_ErrorWithoutNameIsAttributed) {
    ReadyBench bench;
    const auto before = bench.request("I,d,13,1");
    const auto id = bench.request("Z,x,1");
    const auto after = bench.request("I,a,3,1");
    EXPECT_EQ(bench.ending(before), Ending::kExecuted);
    EXPECT_EQ(bench.ending(id), Ending::kBoardError);
    EXPECT_EQ(bench.end_of(id)->code, 1);
    EXPECT_EQ(bench.ending(after), Ending::kExecuted);
}

TEST(BoardSession, NotARequest_IsRefused) {
    ReadyBench bench;
    for (const char* line :
         {"", "x", "@I,d,4,1", "I", "i,d,1", "I,d,\x01", "#,B,500000", "#,C,1", "I,d,13,1\nI,d,13,0"})
        EXPECT_EQ(bench.refused(line), Refusal::kInvalid) << line;
    EXPECT_EQ(bench.refused(std::string("I,d,") + std::string(250, '1')), Refusal::kInvalid);
    EXPECT_EQ(bench.refused(std::string("I,d,") + std::string(59, '1')), Refusal::kTooLong);
}

TEST(BoardSession, RequestOfTheLengthThatTheBoardNames_IsSentWithItsChecksum) {
    Bench bench;
    bench.board.replies["#,X"] = "@#,X,5,{E:1,I:1,B:1,C:1,L:172}";
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.session.checksums());
    const std::string longest = "S,M," + std::string(168, '1');
    const auto id = bench.request(longest);
    const auto next = bench.request("I,d,13,1");
    bench.pass(1s);
    EXPECT_EQ(bench.ending(id), Ending::kExecuted);
    EXPECT_EQ(bench.ending(next), Ending::kExecuted);
    EXPECT_THAT(bench.board.executed, testing::ElementsAre(longest, "I,d,13,1"));
    EXPECT_TRUE(bench.session.checksums());
    EXPECT_EQ(bench.refused(longest + "1"), Refusal::kTooLong);
}

TEST(BoardSession, QueueFull_IsRefused) {
    ReadyBench bench;
    bench.board.mute = true;
    int accepted = 0;
    while (!bench.refused("I,d,13,1") && accepted < 10000)
        ++accepted;
    EXPECT_EQ(bench.refused("I,d,13,1"), Refusal::kQueueFull);
    EXPECT_GE(accepted, static_cast<int>(BoardSession::kMaxQueuedPerClient));
    EXPECT_LE(accepted, static_cast<int>(BoardSession::kMaxQueuedPerClient) + 6);
}

TEST(BoardSession, NoBoard_IsRefused) {
    Bench bench;
    EXPECT_EQ(bench.refused("I,d,13,1"), Refusal::kNoBoard);
    ASSERT_TRUE(bench.start());
    bench.unplug();
    EXPECT_EQ(bench.refused("I,d,13,1"), Refusal::kNoBoard);
}

TEST(BoardSession, LinkGoes_SentTimesOutAndQueuedIsNotSent) {
    ReadyBench bench;
    bench.board.mute = true;
    std::vector<RequestId> ids;
    for (int i = 0; i < 10; ++i)
        ids.push_back(bench.request("I,d,13,1"));
    bench.unplug();
    EXPECT_EQ(bench.ending(ids.front()), Ending::kTimeout);
    EXPECT_EQ(bench.ending(ids.back()), Ending::kNotSent);
    EXPECT_EQ(bench.finished.size(), 10u);
}

TEST_F(OldBoard, FenceComesLate_ProvesItsOwnRequestAndNothingNewer) {
    ASSERT_TRUE(bench.start());
    bench.board.mute = true;
    const auto slow = bench.request("S,W,0,1");
    const auto next = bench.request("S,W,0,2");
    bench.pass(1700ms);
    bench.say("@#,?,0,4,ATmega328P,6,Script\r\n");
    EXPECT_EQ(bench.ending(slow), Ending::kExecuted) << "its own answer, late";
    EXPECT_EQ(bench.end_of(next), nullptr);
    bench.pass(5s);
    ASSERT_NE(bench.end_of(next), nullptr);
    EXPECT_NE(bench.ending(next), Ending::kExecuted);
}

TEST_F(OldBoard, FencesTakeTurns) {
    ASSERT_TRUE(bench.start());
    bench.board.heard.clear();
    for (int i = 0; i < 4; ++i)
        bench.request("I,d,13,1");
    EXPECT_EQ(std::count(bench.board.heard.begin(), bench.board.heard.end(), "#,?"), 2);
    EXPECT_EQ(std::count(bench.board.heard.begin(), bench.board.heard.end(), "#,N"), 2);
}

TEST(BoardSession, ErrorThatBelongsToNoRequest_PutsWhatIsInFlightInDoubt) {
    for (const char* error : {"~#,,,2{UNKNOWN_REQUEST}", "~Q,?,1{INVALID_SERVICE}", "~#,E,11{BAD_ARGUMENT}",
                              "~#,C,10{BAD_CHECKSUM}", "~D,A,11{BAD_ARGUMENT}"}) {
        ReadyBench bench(no_step_up());
        bench.board.replies["S,W,0,1"] = error;
        const auto id = bench.request("S,W,0,1");
        bench.pass(2s);
        EXPECT_EQ(bench.ending(id), Ending::kDoubt) << error;
        EXPECT_EQ(bench.ending(bench.request("S,W,0,2")), Ending::kExecuted);
    }
}

// A late answer must not be taken for a newer one: sixteen bits of fences have tokens of their own.
TEST(Fences, Tokens_DoNotRepeat) {
    Fences fences([engine = std::mt19937_64(1)]() mutable { return engine(); });
    fences.use_echo(false);
    std::set<std::string> tokens;
    for (int i = 0; i < 70'000; ++i)
        tokens.insert(fences.next().token);
    EXPECT_EQ(tokens.size(), 70'000u);
}

TEST(BoardSession, Tokens_DifferBetweenSessionsAndDoNotRepeat) {
    ReadyBench bench;
    bench.board.heard.clear();
    for (int i = 0; i < 500; ++i) {
        bench.request("I,d,13,1");
        bench.finished.clear();
        bench.board.executed.clear();
    }
    std::set<std::string> tokens;
    for (const std::string& line : bench.board.heard)
        if (line.starts_with("#,E,")) tokens.insert(line);
    EXPECT_EQ(tokens.size(), 500u);
    Bench other;
    other.session = Bench::make_session({}, 2);
    other.plug();
    ASSERT_TRUE(other.ready_within());
    other.board.heard.clear();
    other.request("I,d,13,1");
    EXPECT_NE(other.board.heard.back(), *tokens.begin());
}

}  // namespace
}  // namespace asip::session
