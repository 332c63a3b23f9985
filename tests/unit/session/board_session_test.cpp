#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

SessionOptions no_step_up() {
    SessionOptions options;
    options.max_baud = 0;
    return options;
}

struct OldBoard : testing::Test {
    OldBoard() { bench.board.extensions = false; }
    Bench bench;
};

// --- finding and identifying

TEST(BoardSession, BoardWithExtensions_IsIdentifiedAndSteppedUp) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(1s));
    const Identity& board = bench.session.identity();
    EXPECT_EQ(board.info.chip, "ATmega328P");
    EXPECT_EQ(board.stored_name, "uno1");
    EXPECT_EQ(board.services.size(), 3u);
    EXPECT_EQ(board.pin_owners, "@@IISD");
    EXPECT_EQ(board.port_map.pin_count(), 6u);
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

TEST(BoardSession, BoardLeftWithChecksums_IsFound) {
    Bench bench(no_step_up());
    bench.board.checksum = true;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(3s));
    EXPECT_FALSE(bench.board.checksum);
}

TEST(BoardSession, NothingAnswers_SaysSoOnceAndGoesOnAsking) {
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

TEST(BoardSession, OneQuestionUnanswered_RestIsKnown) {
    Bench bench(no_step_up());
    bench.board.replies["I,c"] = "";
    bench.plug();
    ASSERT_TRUE(bench.ready_within(10s));
    EXPECT_THAT(bench.session.identity().pin_capabilities, IsEmpty());
    EXPECT_EQ(bench.session.identity().port_map.pin_count(), 6u);
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

// --- line rate

TEST(BoardSession, FastestRateDoesNotWork_NextIsTaken) {
    Bench bench;
    bench.board.fastest_working = 500'000;
    bench.plug();
    ASSERT_TRUE(bench.ready_within(5s));
    EXPECT_EQ(bench.session.baud(), 500'000u);
    EXPECT_EQ(bench.board.baud, 500'000u);
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
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    for (int i = 0; i < 3; ++i)
        bench.say("\x81\x82garbage\n");
    ASSERT_TRUE(bench.ready_within(5s));
    EXPECT_EQ(bench.session.baud(), 500'000u);
}

// --- requests and fences

TEST(BoardSession, Request_EndsExecutedWhenItsFenceIsBack) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto id = bench.request("I,d,13,1\n");
    ASSERT_NE(bench.end_of(id), nullptr);
    EXPECT_EQ(bench.end_of(id)->ending, Ending::kExecuted);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,d,13,1"));
    EXPECT_EQ(bench.session.bytes_in_flight(), 0u);
}

TEST_F(OldBoard, Request_IsProvenByTheInformationRequest) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto id = bench.request("I,d,13,1");
    ASSERT_NE(bench.end_of(id), nullptr);
    EXPECT_EQ(bench.end_of(id)->ending, Ending::kExecuted);
    EXPECT_EQ(bench.board.heard.back(), "#,?");
    EXPECT_THAT(bench.lines, IsEmpty());
}

TEST(BoardSession, BoardError_EndsTheRequestAndIsHandedOn) {
    Bench bench;
    bench.board.replies["S,W,9,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto id = bench.request("S,W,9,90");
    ASSERT_NE(bench.end_of(id), nullptr);
    EXPECT_EQ(bench.end_of(id)->ending, Ending::kBoardError);
    EXPECT_EQ(bench.end_of(id)->code, 7);
    EXPECT_EQ(bench.end_of(id)->text, "INVALID_DEVICE_NUMBER");
    EXPECT_THAT(bench.lines, ElementsAre("~S,W,7{INVALID_DEVICE_NUMBER}"));
    EXPECT_EQ(bench.finished.size(), 1u);
}

enum class Generation { kPlain04, kExtended, kVerified };

class EachGeneration : public testing::TestWithParam<Generation> {
  protected:
    EachGeneration() {
        bench.board.extensions = GetParam() != Generation::kPlain04;
        bench.board.verified_fences = GetParam() == Generation::kVerified;
    }
    Bench bench;
};
INSTANTIATE_TEST_SUITE_P(Boards, EachGeneration,
                         testing::Values(Generation::kPlain04, Generation::kExtended, Generation::kVerified),
                         [](const auto& tested) -> std::string {
                             if (tested.param == Generation::kPlain04) return "Plain04";
                             return tested.param == Generation::kVerified ? "Verified" : "Extended";
                         });

TEST_P(EachGeneration, AlikeRequestsAtOnce_EachEndsWithItsOwnOutcome) {
    bench.board.replies["S,W,9,1"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
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
        timeouts += bench.end_of(bad[i])->ending != Ending::kExecuted &&
                    bench.end_of(bad[i])->ending != Ending::kBoardError;
        if (bench.end_of(bad[i])->ending == Ending::kExecuted)
            ADD_FAILURE() << "bad request " << i << " proven";
        if (bench.end_of(good[i])->ending == Ending::kBoardError)
            ADD_FAILURE() << "good request " << i << " refused";
    }
    EXPECT_GE(timeouts, 1);
    EXPECT_EQ(bench.finished.size(), 100u);
    EXPECT_LE(bench.most_in_flight, BoardSession::kReceiveBufferBytes);
}

TEST_P(EachGeneration, ThousandRequestsOfManyClients_NeverMoreThanTheBufferInFlight) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    for (int i = 0; i < 1000; ++i)
        bench.request(i % 3 ? "I,d,13,1" : "S,W,0,90", {.client = ClientId(i / 60), .prove = i % 2 == 0});
    bench.pass(5s);
    EXPECT_EQ(bench.finished.size(), 1000u);
    EXPECT_LE(bench.most_in_flight, BoardSession::kReceiveBufferBytes);
    EXPECT_EQ(bench.board.executed.size(), 1000u);
}

TEST_P(EachGeneration, FenceLost_RequestIsInDoubtAndTheNextWorks) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.board.swallow_fences = 1;
    const auto lost = bench.request("I,d,13,1");
    bench.say_line("@I,a,1,{0:1}");
    bench.pass(1s);
    bench.say_line("@I,a,1,{0:1}");
    bench.pass(1s);
    ASSERT_NE(bench.end_of(lost), nullptr);
    EXPECT_EQ(bench.end_of(lost)->ending, Ending::kDoubt);
    const auto next = bench.request("I,d,13,0");
    ASSERT_NE(bench.end_of(next), nullptr);
    EXPECT_EQ(bench.end_of(next)->ending, Ending::kExecuted);
    EXPECT_EQ(bench.count("silent"), 0);
}

TEST_P(EachGeneration, UnprovenRequests_CostNoFenceEach) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
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
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto id = bench.request("#,?", {.prove = true, .answer_tag = '?'});
    ASSERT_NE(bench.end_of(id), nullptr);
    EXPECT_EQ(bench.end_of(id)->ending, Ending::kExecuted);
    EXPECT_EQ(bench.end_of(id)->answer.text(), "@#,?,0,4,ATmega328P,6,Script");
    EXPECT_THAT(bench.lines, ElementsAre("@#,?,0,4,ATmega328P,6,Script"));
}

class VerifiedFences : public testing::TestWithParam<ChecksumPolicy> {
  protected:
    VerifiedFences() : bench({.checksum = GetParam()}) {
        bench.board.verified_fences = true;
        bench.plug();
        EXPECT_TRUE(bench.ready_within());
        EXPECT_EQ(ending_of("I,d,13,0"), Ending::kExecuted);
    }
    std::optional<Ending> ending_of(const std::string& line) {
        const auto id = bench.request(line);
        bench.pass(1s);
        const auto* const end = bench.end_of(id);
        return end ? std::optional(end->ending) : std::nullopt;
    }
    Bench bench;
};
INSTANTIATE_TEST_SUITE_P(Checksums, VerifiedFences,
                         testing::Values(ChecksumPolicy::kNever, ChecksumPolicy::kAlways),
                         [](const auto& tested) -> std::string {
                             return tested.param == ChecksumPolicy::kNever ? "Without" : "With";
                         });

TEST_P(VerifiedFences, WholeRequestIsLostWithItsLineEnd_DoubtAndTheNextIsProven) {
    bench.board.lose_lines = 1;
    EXPECT_EQ(ending_of("I,d,13,1"), Ending::kDoubt);
    EXPECT_EQ(bench.session.counters().contradictions, 1u);
    EXPECT_EQ(ending_of("I,d,13,1"), Ending::kExecuted);
}

TEST_P(VerifiedFences, RequestBecomesAnotherOfTheSameChecksum_DoubtAndTheNextIsProven) {
    bench.board.misreads["I,d,13,1"] = "I,d,12,0";
    EXPECT_EQ(ending_of("I,d,13,1"), Ending::kDoubt);
    bench.board.misreads.clear();
    EXPECT_EQ(ending_of("I,d,13,1"), Ending::kExecuted);
}

TEST_P(VerifiedFences, ErrorOfTheBoardIsLost_DoubtNotOk) {
    bench.board.replies["S,W,9,90"] = "";
    EXPECT_EQ(ending_of("S,W,9,90"), Ending::kExecuted);
    bench.board.lost_errors["S,W,9,90"] = 7;
    EXPECT_EQ(ending_of("S,W,9,90"), Ending::kDoubt);
    bench.board.replies["S,W,8,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    EXPECT_EQ(ending_of("S,W,8,90"), Ending::kBoardError);
}

TEST_P(VerifiedFences, ErrorOfOneOfTwoThatLookAlike_IsNoContradiction) {
    bench.board.replies["S,W,8,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.request("S,W,8,90", {.prove = false});
    bench.request("S,W,0,90", {.prove = false});
    EXPECT_EQ(ending_of("I,d,13,1"), Ending::kExecuted);
    EXPECT_EQ(bench.session.counters().contradictions, 0u);
}

TEST_P(VerifiedFences, ManyRequestsOfManyClients_AllAreProven) {
    std::vector<RequestId> ids;
    for (int i = 0; i < 200; ++i)
        ids.push_back(bench.request(i % 3 ? "I,d,13,1 " : "S,W,0,90", {.client = ClientId(i % 7)}));
    bench.pass(5s);
    for (const auto id : ids)
        ASSERT_EQ(bench.end_of(id)->ending, Ending::kExecuted);
    EXPECT_EQ(bench.session.counters().contradictions, 0u);
}

TEST_P(VerifiedFences, RequestThatBeginsTheDigestAnew_IsForTheSessionAlone) {
    EXPECT_EQ(bench.refused("#,V,mine"), Refusal::kInvalid);
}

TEST(BoardSession, ClientSendsAFence_GetsItsOwnAnswerOnly) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto id = bench.request("#,E,mine");
    EXPECT_THAT(bench.lines, ElementsAre("@#,E,mine"));
    EXPECT_EQ(bench.end_of(id)->ending, Ending::kExecuted);
}

TEST(BoardSession, AnswerEvent_ComesWithTheEnd) {
    Bench bench;
    bench.board.replies["D,M"] = "@D,e,2,{42,118}";
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto id = bench.request("D,M", {.prove = true, .answer_tag = 'e'});
    EXPECT_EQ(bench.end_of(id)->answer.text(), "@D,e,2,{42,118}");
    EXPECT_THAT(bench.lines, ElementsAre("@D,e,2,{42,118}"));
}

TEST(BoardSession, ServiceTheBoardDoesNotHave_ErrorWithoutNameIsAttributed) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto before = bench.request("I,d,13,1");
    const auto id = bench.request("Z,x,1");
    const auto after = bench.request("I,a,3,1");
    EXPECT_EQ(bench.end_of(before)->ending, Ending::kExecuted);
    EXPECT_EQ(bench.end_of(id)->ending, Ending::kBoardError);
    EXPECT_EQ(bench.end_of(id)->code, 1);
    EXPECT_EQ(bench.end_of(after)->ending, Ending::kExecuted);
}

TEST(BoardSession, NotARequest_IsRefused) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    for (const char* line :
         {"", "x", "@I,d,4,1", "I", "i,d,1", "I,d,\x01", "#,B,500000", "#,C,1", "I,d,13,1\nI,d,13,0"})
        EXPECT_EQ(bench.refused(line), Refusal::kInvalid) << line;
    EXPECT_EQ(bench.refused(std::string("I,d,") + std::string(80, '1')), Refusal::kInvalid);
}

TEST(BoardSession, QueueFull_IsRefused) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
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
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.unplug();
    EXPECT_EQ(bench.refused("I,d,13,1"), Refusal::kNoBoard);
}

TEST(BoardSession, LinkGoes_SentTimesOutAndQueuedIsNotSent) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.board.mute = true;
    std::vector<RequestId> ids;
    for (int i = 0; i < 10; ++i)
        ids.push_back(bench.request("I,d,13,1"));
    bench.unplug();
    EXPECT_EQ(bench.end_of(ids.front())->ending, Ending::kTimeout);
    EXPECT_EQ(bench.end_of(ids.back())->ending, Ending::kNotSent);
    EXPECT_EQ(bench.finished.size(), 10u);
}

// --- what proves and what does not

TEST_F(OldBoard, FenceComesLate_ProvesItsOwnRequestAndNothingNewer) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.board.mute = true;
    const auto slow = bench.request("S,W,0,1");
    const auto next = bench.request("S,W,0,2");
    bench.pass(1700ms);
    bench.say("@#,?,0,4,ATmega328P,6,Script\r\n");
    ASSERT_NE(bench.end_of(slow), nullptr);
    EXPECT_EQ(bench.end_of(slow)->ending, Ending::kExecuted) << "its own answer, late";
    EXPECT_EQ(bench.end_of(next), nullptr);
    bench.pass(5s);
    ASSERT_NE(bench.end_of(next), nullptr);
    EXPECT_NE(bench.end_of(next)->ending, Ending::kExecuted);
}

TEST_F(OldBoard, FencesTakeTurns) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.board.heard.clear();
    for (int i = 0; i < 4; ++i)
        bench.request("I,d,13,1");
    EXPECT_EQ(std::count(bench.board.heard.begin(), bench.board.heard.end(), "#,?"), 2);
    EXPECT_EQ(std::count(bench.board.heard.begin(), bench.board.heard.end(), "#,N"), 2);
}

TEST(BoardSession, ErrorThatBelongsToNoRequest_PutsWhatIsInFlightInDoubt) {
    for (const char* error : {"~#,,,2{UNKNOWN_REQUEST}", "~Q,?,1{INVALID_SERVICE}", "~#,E,11{BAD_ARGUMENT}",
                              "~#,C,10{BAD_CHECKSUM}", "~D,A,11{BAD_ARGUMENT}"}) {
        Bench bench(no_step_up());
        bench.plug();
        ASSERT_TRUE(bench.ready_within());
        bench.board.replies["S,W,0,1"] = error;
        const auto id = bench.request("S,W,0,1");
        bench.pass(2s);
        ASSERT_NE(bench.end_of(id), nullptr) << error;
        EXPECT_EQ(bench.end_of(id)->ending, Ending::kDoubt) << error;
        EXPECT_EQ(bench.end_of(bench.request("S,W,0,2"))->ending, Ending::kExecuted);
    }
}

TEST(BoardSession, Tokens_DifferBetweenSessionsAndDoNotRepeat) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.board.heard.clear();
    for (int i = 0; i < 70'000; ++i) {
        bench.request("I,d,13,1");
        bench.finished.clear();
        bench.board.executed.clear();
    }
    std::set<std::string> tokens;
    for (const std::string& line : bench.board.heard)
        if (line.starts_with("#,E,")) tokens.insert(line);
    EXPECT_EQ(tokens.size(), 70'000u);
    Bench other;
    other.session = Bench::make_session({}, 2);
    other.plug();
    ASSERT_TRUE(other.ready_within());
    other.board.heard.clear();
    other.request("I,d,13,1");
    EXPECT_NE(other.board.heard.back(), *tokens.begin());
}

// --- the line

TEST_P(EachGeneration, LongestRequestsWithReportsOn_NeverMoreThanTheBufferAndAllExecuted) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const std::string line = "S,W,0," + std::string(56, '1');
    ASSERT_EQ(line.size(), 62u);
    std::vector<RequestId> ids;
    for (int i = 0; i < 50; ++i) {
        bench.say_line("@I,a,1,{0:320}");
        ids.push_back(bench.request(line));
        bench.pass(20ms);
    }
    bench.pass(10s);
    for (const auto id : ids) {
        ASSERT_NE(bench.end_of(id), nullptr);
        EXPECT_EQ(bench.end_of(id)->ending, Ending::kExecuted);
    }
    EXPECT_LE(bench.most_in_flight, BoardSession::kReceiveBufferBytes);
    EXPECT_EQ(bench.count("silent"), 0);
}

TEST(BoardSession, FastLine_CarriesChecksumsUnasked) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    EXPECT_EQ(bench.session.baud(), 1'000'000u);
    EXPECT_TRUE(bench.board.checksum);
}

TEST(BoardSession, SlowLine_CarriesChecksumsFromTheFirstDamageOn) {
    Bench bench(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    EXPECT_FALSE(bench.board.checksum);
    bench.say("nonsense\n");
    EXPECT_TRUE(bench.board.checksum);
    EXPECT_EQ(bench.end_of(bench.request("I,d,13,1"))->ending, Ending::kExecuted);
}

TEST(BoardSession, ChecksumsStillOnAndTurningThemOffIsLost_IdentityIsWhole) {
    for (int lost = 0; lost < 12; ++lost) {
        Bench bench(no_step_up());
        bench.board.checksum = true;
        bench.board.lose_lines = lost;
        bench.plug();
        ASSERT_TRUE(bench.ready_within(10s)) << lost;
        EXPECT_EQ(bench.session.identity().info.sketch, "Script");
        EXPECT_EQ(bench.session.identity().services.size(), 3u);
    }
}

// --- values

TEST(BoardSession, ValueComesAfterTheFence_IsWaitedFor) {
    Bench bench(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto id = bench.request("D,M", {.answer_tag = 'e'});
    EXPECT_EQ(bench.end_of(id), nullptr) << "executed, but not measured yet";
    bench.pass(25ms);
    bench.say_line("@D,e,1,{42}");
    ASSERT_NE(bench.end_of(id), nullptr);
    EXPECT_EQ(bench.end_of(id)->ending, Ending::kExecuted);
    EXPECT_EQ(bench.end_of(id)->answer.text(), "@D,e,1,{42}");
}

TEST(BoardSession, ValueDoesNotCome_EndsWithoutIt) {
    Bench bench(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto id = bench.request("D,M", {.answer_tag = 'e', .answer_time = 500ms});
    bench.pass(500ms);
    ASSERT_NE(bench.end_of(id), nullptr);
    EXPECT_EQ(bench.end_of(id)->ending, Ending::kNoValue);
}

TEST(BoardSession, TwoClientsAskForAMeasurementAtOnce_TheSecondWaitsForTheFirstAndBothGetValues) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto first = bench.request("D,M", {.client = 1, .answer_tag = 'e'});
    const auto second = bench.request("D,M", {.client = 2, .answer_tag = 'e'});
    const auto other = bench.request("I,d,13,1", {.client = 2});
    const auto third = bench.request("I,d,13,0", {.client = 3});
    EXPECT_EQ(bench.end_of(third)->ending, Ending::kExecuted) << "nobody else waits for it";
    EXPECT_EQ(bench.end_of(other), nullptr) << "the order of a client is kept";
    bench.say_line("@D,e,1,{42}");
    EXPECT_EQ(bench.end_of(first)->answer.text(), "@D,e,1,{42}");
    EXPECT_EQ(bench.end_of(second), nullptr) << "the measurement had begun before it was asked for";
    bench.say_line("@D,e,1,{43}");
    ASSERT_NE(bench.end_of(second), nullptr);
    EXPECT_EQ(bench.end_of(second)->answer.text(), "@D,e,1,{43}");
    EXPECT_EQ(bench.end_of(other)->ending, Ending::kExecuted);
}

TEST(BoardSession, ReportBeforeTheFence_IsNotTakenForTheValue) {
    Bench bench(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.request("D,A,100");
    bench.pass(1s);
    bench.board.replies["D,M"] = "@D,e,1,{1}";
    const auto id = bench.request("D,M", {.answer_tag = 'e'});
    EXPECT_THAT(bench.lines, Contains("@D,e,1,{1}"));
    EXPECT_EQ(bench.end_of(id), nullptr) << "it may be a report from before";
    bench.say_line("@D,e,1,{2}");
    ASSERT_NE(bench.end_of(id), nullptr);
    EXPECT_EQ(bench.end_of(id)->answer.text(), "@D,e,1,{2}");
}

// --- clients and deadlines

TEST(BoardSession, FloodOfOneClient_AnotherWaitsForOneRequestOnly) {
    Bench bench(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
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
    Bench bench(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.board.mute = true;
    std::vector<RequestId> ids;
    for (int i = 0; i < 10; ++i)
        ids.push_back(bench.request("S,W,0," + std::to_string(i), {.deadline = bench.now + 300ms}));
    bench.pass(300ms);
    ASSERT_NE(bench.end_of(ids.back()), nullptr);
    EXPECT_EQ(bench.end_of(ids.back())->ending, Ending::kNotSent);
    EXPECT_EQ(bench.end_of(ids.back())->not_sent, NotSent::kDeadline);
    EXPECT_EQ(bench.end_of(ids.front())->ending, Ending::kTimeout);
    bench.board.mute = false;
    bench.pass(20s);
    EXPECT_THAT(bench.board.executed, Not(Contains("S,W,0,9")));
}

// --- restarts and silence

TEST_P(EachGeneration, BannerInMidStream_ModesAndPeriodsAreRestoredValuesAreNot) {
    SessionOptions options = no_step_up();
    bench.session = Bench::make_session(options);
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    for (const char* line : {"I,P,13,3", "I,d,13,1", "D,A,100", "S,W,0,90", "I,P,12,2"})
        bench.request(line);
    bench.board.executed.clear();
    bench.say(bench.board.reboot());
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_EQ(bench.count("reset"), 1);
    EXPECT_EQ(bench.count("identified"), 2);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,P,12,2", "I,P,13,3", "D,A,100"));
    EXPECT_EQ(bench.session.period('D'), 100u);
}

TEST_P(EachGeneration, BannerCutInHalf_IsStillARestart) {
    bench.session = Bench::make_session(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.request("I,P,13,3");
    bench.board.executed.clear();
    bench.say("ing on ATmega328P with Services: I S D \r\n");
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_THAT(bench.board.executed, ElementsAre("I,P,13,3"));
}

TEST(BoardSession, RestartAtAFastRate_IsNoticedByGarbageAndRestored) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
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
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.request("I,P,1,3");
    bench.board.executed.clear();
    bench.say(bench.board.reboot());
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST(BoardSession, ClientRestartsTheBoard_NothingIsRestored) {
    Bench bench(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.request("I,P,13,3");
    bench.request("#,R");
    bench.board.executed.clear();
    bench.say(bench.board.reboot());
    ASSERT_TRUE(bench.ready_within(1s));
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST(BoardSession, Replugged_SettingsAreRestored) {
    Bench bench;
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
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
    Bench bench(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.request("I,P,13,3");
    bench.board.mute = true;
    bench.say(bench.board.reboot());
    bench.board.executed.clear();
    const auto id = bench.request("I,d,13,1");
    bench.board.mute = false;
    ASSERT_TRUE(bench.ready_within(5s));
    EXPECT_THAT(bench.board.executed, ElementsAre("I,P,13,3", "I,d,13,1"));
    EXPECT_EQ(bench.end_of(id)->ending, Ending::kExecuted);
}

TEST_P(EachGeneration, QuietBoard_IsProbedAndStaysReady) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.pass(1min);
    EXPECT_EQ(bench.session.state(), BoardSession::State::kReady);
    EXPECT_EQ(bench.count("silent"), 0);
    EXPECT_GE(bench.board.heard.size(), 20u);
    EXPECT_THAT(bench.lines, IsEmpty());
}

TEST_P(EachGeneration, BoardStopsAnswering_IsSilentWithinFourSecondsAndFoundAgain) {
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.board.mute = true;
    bench.pass(4s);
    EXPECT_EQ(bench.count("silent"), 1);
    EXPECT_EQ(bench.session.state(), BoardSession::State::kSilent);
    EXPECT_EQ(bench.refused("I,d,13,1"), Refusal::kNoBoard);
    bench.board.mute = false;
    ASSERT_TRUE(bench.ready_within(5s));
    EXPECT_EQ(bench.count("identified"), 2);
}

// --- garbage

TEST_P(EachGeneration, GarbageInManyForms_IsCountedAndTheNextMessageWorks) {
    bench.session = Bench::make_session(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
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
    Bench bench(no_step_up());
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    bench.say("@I,a,1,{");
    bench.pass(1min);
    ASSERT_TRUE(bench.ready_within(5s));
    const auto id = bench.request("I,d,13,1");
    bench.pass(2s);
    ASSERT_NE(bench.end_of(id), nullptr);
}

// --- checksum

TEST(BoardSession, ChecksumWanted_LinesCarryItBothWays) {
    SessionOptions options = no_step_up();
    options.checksum = ChecksumPolicy::kAlways;
    Bench bench(options);
    bench.plug();
    ASSERT_TRUE(bench.ready_within());
    const auto id = bench.request("I,d,13,1");
    EXPECT_TRUE(bench.board.checksum);
    EXPECT_EQ(bench.end_of(id)->ending, Ending::kExecuted);
    bench.say("@I,d,4,c*00\r\n");
    EXPECT_EQ(bench.session.counters().checksum_errors, 1u);
    EXPECT_THAT(bench.lines, IsEmpty());
    bench.say("@I,d,4,c*26\r\n");
    EXPECT_THAT(bench.lines.size() + bench.session.counters().checksum_errors, 2u);
}

}  // namespace
}  // namespace asip::session
