// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/protocol/body.hpp"
#include "tests/unit/session/board_session_bench.hpp"
#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {
namespace {

using testing::Contains;
using testing::IsEmpty;

TEST_P(EachGeneration, LongestRequestsWithReportsOn_NeverMoreThanTheBufferAndAllExecuted) {
    ASSERT_TRUE(bench.start());
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
        EXPECT_EQ(bench.ending(id), Ending::kExecuted);
    }
    EXPECT_LE(bench.most_in_flight, BoardSession::kReceiveBufferBytes);
    EXPECT_EQ(bench.count("silent"), 0);
}

TEST(BoardSession, FastLine_CarriesChecksumsUnasked) {
    ReadyBench bench;
    EXPECT_EQ(bench.session.baud(), 1'000'000u);
    EXPECT_TRUE(bench.board.checksum);
}

TEST(BoardSession, SlowLine_CarriesChecksumsFromTheFirstDamageOn) {
    ReadyBench bench(no_step_up());
    EXPECT_FALSE(bench.board.checksum);
    bench.say("nonsense\n");
    EXPECT_TRUE(bench.board.checksum);
    EXPECT_EQ(bench.ending(bench.request("I,d,13,1")), Ending::kExecuted);
}

// A request that has no room for a checksum in the board's buffer goes without, and so does all that the
// board says then.
TEST(BoardSession, LongRequestWhileAValueIsAwaited_ValueKeepsItsChecksum) {
    ReadyBench bench;
    ASSERT_TRUE(bench.board.checksum);
    const std::string longest = "S,W,0," + std::string(56, '1');
    const auto value = bench.request("D,M", {.client = 1, .answer_tag = 'e', .answer_time = 500ms});
    const auto first = bench.request(longest, {.client = 2});
    bench.pass(100ms);
    EXPECT_TRUE(bench.board.checksum);
    EXPECT_EQ(bench.end_of(first), nullptr);
    bench.say_line("@D,e,1,{42}");
    bench.pass(100ms);
    EXPECT_EQ(bench.ending(value), Ending::kExecuted);
    EXPECT_EQ(bench.ending(first), Ending::kExecuted);

    bench.request("D,M", {.client = 1, .answer_tag = 'e', .answer_time = 500ms});
    const auto second = bench.request(longest, {.client = 2});
    bench.pass(1s);
    EXPECT_EQ(bench.ending(second), Ending::kExecuted) << "a value that never comes holds up nobody for long";
}

TEST(BoardSession, ChecksumsStillOnAndTurningThemOffIsLost_IdentityIsWhole) {
    for (int lost = 0; lost < 12; ++lost) {
        Bench bench(no_step_up());
        bench.board.checksum = true;
        bench.board.lose_lines = lost;
        bench.plug();
        ASSERT_TRUE(bench.ready_within(11s)) << lost;
        EXPECT_EQ(bench.session.identity().info.sketch, "Script");
        EXPECT_EQ(bench.session.identity().services.size(), 3u);
    }
}

TEST(BoardSession, ValueComesAfterTheFence_IsWaitedFor) {
    ReadyBench bench(no_step_up());
    const auto id = bench.request("D,M", {.answer_tag = 'e'});
    EXPECT_EQ(bench.end_of(id), nullptr) << "executed, but not measured yet";
    bench.pass(25ms);
    bench.say_line("@D,e,1,{42}");
    EXPECT_EQ(bench.ending(id), Ending::kExecuted);
    EXPECT_EQ(bench.answer(id), "@D,e,1,{42}");
}

TEST(BoardSession, ValueDoesNotCome_EndsWithoutIt) {
    ReadyBench bench(no_step_up());
    const auto id = bench.request("D,M", {.answer_tag = 'e', .answer_time = 500ms});
    bench.pass(500ms);
    EXPECT_EQ(bench.ending(id), Ending::kNoValue);
}

TEST(BoardSession, TwoClientsAskForAMeasurementAtOnce_TheSecondWaitsForTheFirstAndBothGetValues) {
    ReadyBench bench;
    const auto first = bench.request("D,M", {.client = 1, .answer_tag = 'e'});
    const auto second = bench.request("D,M", {.client = 2, .answer_tag = 'e'});
    const auto other = bench.request("I,d,13,1", {.client = 2});
    const auto third = bench.request("I,d,13,0", {.client = 3});
    EXPECT_EQ(bench.ending(third), Ending::kExecuted) << "nobody else waits for it";
    EXPECT_EQ(bench.end_of(other), nullptr) << "the order of a client is kept";
    bench.say_line("@D,e,1,{42}");
    EXPECT_EQ(bench.answer(first), "@D,e,1,{42}");
    EXPECT_EQ(bench.end_of(second), nullptr) << "the measurement had begun before it was asked for";
    bench.say_line("@D,e,1,{43}");
    EXPECT_EQ(bench.answer(second), "@D,e,1,{43}");
    EXPECT_EQ(bench.ending(other), Ending::kExecuted);
}

bool is_list(const protocol::Event& event) {
    return protocol::parse_body(event.body).has_value();
}

TEST_P(EachGeneration, ValueMergedWithAnotherLine_IsNotTaken) {
    ASSERT_TRUE(bench.start());
    for (const char* merged : {"@D,e,{0:0,1:0}", "@D,e,2,{0:0,1:0,2:0}"}) {
        const auto id = bench.request("D,M", {.answer_tag = 'e', .is_answer = is_list});
        bench.say_line(merged);
        EXPECT_EQ(bench.ending(id), Ending::kDoubt) << merged;
    }
}

TEST_F(OldBoard, BeginningOfALineWithinAnother_DoubtsWhatIsUnderWay) {
    ASSERT_TRUE(bench.start());
    bench.board.mute = true;
    for (const char* merged : {"@D,e,1,{4@I,a,1,{0:320}", "@D,e,1,{~I,d,11{BAD_ARGUMENT}"}) {
        const auto id = bench.request("I,d,13,1");
        bench.say_line(merged);
        bench.say_line("@#,?,0,4,ATmega328P,20,Script");
        bench.say_line("@#,N,3,{I:ASIP core IO,S:Servos,D:Distance}");
        EXPECT_EQ(bench.ending(id), Ending::kDoubt) << merged;
    }
}

TEST_F(OldBoard, AnswerToAFenceIsDamaged_DoubtsWhatIsUnderWay) {
    ASSERT_TRUE(bench.start());
    bench.board.mute = true;
    for (int i = 0; i < 2; ++i) {
        const auto id = bench.request("I,d,13,1");
        bench.say_line("@#,?,0,4,AT");
        bench.say_line("@#,N,3,{I:ASIP core IO,0:320}");
        EXPECT_EQ(bench.ending(id), Ending::kDoubt);
    }
}

TEST_F(OldBoard, ValueOfARequestWhoseDeadlineCameFirst_IsNotThatOfTheNext) {
    ASSERT_TRUE(bench.start());
    const auto first = bench.request("D,M", {.deadline = bench.now + 20ms, .answer_tag = 'e'});
    bench.pass(20ms);
    ASSERT_NE(bench.end_of(first), nullptr);
    ASSERT_EQ(bench.ending(bench.request("I,d,13,1")), Ending::kExecuted);
    bench.board.mute = true;
    const auto second = bench.request("D,M", {.answer_tag = 'e'});
    bench.say_line("@D,e,1,{1}");
    bench.say_line("@#,?,0,4,ATmega328P,20,Script");
    bench.say_line("@#,N,3,{I:ASIP core IO,S:Servos,D:Distance}");
    EXPECT_EQ(bench.end_of(second), nullptr);
    bench.say_line("@D,e,1,{2}");
    EXPECT_EQ(bench.answer(second), "@D,e,1,{2}");
}

TEST_F(OldBoard, BoardStoodStillWhileItMeasured_ValueIsNotThatOfTheNext) {
    ASSERT_TRUE(bench.start());
    const auto first = bench.request("D,M", {.answer_tag = 'e', .answer_time = 500ms});
    bench.board.mute = true;
    bench.request("I,d,13,1");
    bench.pass(1600ms);
    ASSERT_EQ(bench.ending(first), Ending::kNoValue);
    bench.say_line("@#,?,0,4,ATmega328P,20,Script");
    bench.say_line("@#,N,3,{I:ASIP core IO,S:Servos,D:Distance}");
    bench.pass(10ms);
    const auto second = bench.request("D,M", {.answer_tag = 'e', .answer_time = 500ms});
    bench.say_line("@D,e,1,{1}");
    bench.say_line("@#,?,0,4,ATmega328P,20,Script");
    bench.say_line("@#,N,3,{I:ASIP core IO,S:Servos,D:Distance}");
    EXPECT_EQ(bench.end_of(second), nullptr);
}

TEST(BoardSession, PeriodIsOnItsWayToTheBoard_AReportIsNotTheValueThatWasAskedFor) {
    ReadyBench bench(no_step_up());
    bench.board.heard.clear();
    bench.board.swallow_fences = 2;
    const auto period = bench.request("D,A,100");
    const auto id = bench.request("D,M", {.answer_tag = 'e'});
    bench.say_line("@D,e,1,{1}");
    for (const auto& line : std::vector(bench.board.heard))
        if (line.starts_with("#,E")) bench.say_line('@' + line);
    EXPECT_EQ(bench.ending(period), Ending::kExecuted);
    EXPECT_EQ(bench.end_of(id), nullptr);
    bench.say_line("@D,e,1,{2}");
    EXPECT_EQ(bench.answer(id), "@D,e,1,{2}");
}

TEST(BoardSession, ErrorInPlaceOfTheValue_EndsTheRequestWithIt) {
    ReadyBench bench(no_step_up());
    const auto id = bench.request("D,M", {.client = 7, .answer_tag = 'e', .answer_time = 500ms});
    bench.pass(50ms);
    ASSERT_EQ(bench.end_of(id), nullptr) << "executed, but without its value";
    bench.say_line("~D,e,8{DEVICE_NOT_AVAILABLE}");
    bench.pass(1ms);
    EXPECT_EQ(bench.ending(id), Ending::kBoardError);
    EXPECT_EQ(bench.end_of(id)->code, 8);
    EXPECT_EQ(bench.owned_lines.back().second, ClientId(7));
    EXPECT_EQ(bench.session.counters().unexplained_errors, 0u);
}

TEST(BoardSession, ErrorInPlaceOfTheValueBeforeTheFence_EndsTheRequestBehindIt) {
    Bench bench(no_step_up());
    bench.board.replies["D,M"] = "~D,e,8{DEVICE_NOT_AVAILABLE}";
    ASSERT_TRUE(bench.start());
    const auto id = bench.request("D,M", {.answer_tag = 'e'});
    const auto next = bench.request("I,d,13,1");
    bench.pass(1ms);
    EXPECT_EQ(bench.ending(id), Ending::kBoardError);
    EXPECT_EQ(bench.end_of(id)->code, 8);
    EXPECT_EQ(bench.ending(next), Ending::kExecuted);
    EXPECT_EQ(bench.session.counters().unexplained_errors, 0u);
}

TEST(BoardSession, BoardReportedBeforeTheSessionWasReady_ReportIsNotTakenForTheValue) {
    Bench bench(no_step_up());
    bench.plug({57600, true});
    bench.say_line("@D,e,1,{1}");  // an earlier client had set a period
    ASSERT_TRUE(bench.ready_within());
    bench.board.replies["D,M"] = "@D,e,1,{2}";  // a report on its way
    const auto id = bench.request("D,M", {.answer_tag = 'e'});
    EXPECT_EQ(bench.end_of(id), nullptr);
    bench.say_line("@D,e,1,{3}");
    EXPECT_EQ(bench.answer(id), "@D,e,1,{3}");
}

TEST(BoardSession, ReportBeforeTheFence_IsNotTakenForTheValue) {
    ReadyBench bench(no_step_up());
    bench.request("D,A,100");
    bench.pass(1s);
    bench.board.replies["D,M"] = "@D,e,1,{1}";
    const auto id = bench.request("D,M", {.answer_tag = 'e'});
    EXPECT_THAT(bench.lines, Contains("@D,e,1,{1}"));
    EXPECT_EQ(bench.end_of(id), nullptr) << "it may be a report from before";
    bench.say_line("@D,e,1,{2}");
    EXPECT_EQ(bench.answer(id), "@D,e,1,{2}");
}

TEST(BoardSession, ChecksumWanted_LinesCarryItBothWays) {
    SessionOptions options = no_step_up();
    options.checksum = ChecksumPolicy::kAlways;
    ReadyBench bench(options);
    const auto id = bench.request("I,d,13,1");
    EXPECT_TRUE(bench.board.checksum);
    EXPECT_EQ(bench.ending(id), Ending::kExecuted);
    bench.say("@I,d,4,c*00\r\n");
    EXPECT_EQ(bench.session.counters().checksum_errors, 1u);
    EXPECT_THAT(bench.lines, IsEmpty());
    bench.say("@I,d,4,c*26\r\n");
    EXPECT_THAT(bench.lines.size() + bench.session.counters().checksum_errors, 2u);
}

}  // namespace
}  // namespace asip::session
