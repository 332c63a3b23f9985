// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "simulated_program.hpp"

namespace asip::caller {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class CallTest : public testing::Test, protected SimulatedProgram {
  protected:
    void SetUp() override { connect(); }
};

TEST_F(CallTest, Command_SaysWhereItsAnswerGoesAndByWhen) {
    const auto call = write();
    ASSERT_EQ(sent.size(), 1u);
    const auto members = json::parse(sent[0].payload);
    EXPECT_EQ(members, (json{{"raw", "W,0,90"},
                             {"reply_to", "asip/reply/ann/uno1/me"},
                             {"id", call.id()},
                             {"clock", ""},
                             {"deadline_ms", 5000}}));
    EXPECT_EQ(sent[0].response_topic, "asip/reply/ann/uno1/me");
    EXPECT_EQ(sent[0].expiry_seconds, 5u);
    EXPECT_THAT(subscribed, ElementsAre("asip/reply/ann/+/me"));
}

TEST_F(CallTest, AnswerThatComesTwice_IsToldOnce) {
    const auto call = write();
    answer(sent[0], {{"status", "ok"}, {"proof", "fence"}});
    answer(sent[0], {{"status", "error"}, {"code", 7}});
    pass(1min);
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_TRUE(replies[0].succeeded());
}

TEST_F(CallTest, NoAnswer_EndsItBehindItsDeadlineAndSaysThatItMayHaveBeenExecuted) {
    const auto call = command({.topic = "asip/uno1/servo/in",
                               .payload = "W,0,90",
                               .deadline = 300ms,
                               .silence = "no answer to S,W,0,90"});
    pass(799ms);
    EXPECT_TRUE(replies.empty());
    pass(1ms);
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(replies[0].reason, "no-answer");
    EXPECT_EQ(bus::sentence_of(replies[0]), "no answer to S,W,0,90; it may or may not have been executed");
    answer(sent[0], {{"status", "ok"}});
    EXPECT_EQ(replies.size(), 1u);
}

TEST_F(CallTest, DeadlineWhileTheConnectionIsLost_SaysSo) {
    const auto call = write();
    lose("mqtt://hub:1883 closed the connection");
    pass(5500ms);
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(replies[0].reason, "connection");
    EXPECT_EQ(bus::sentence_of(replies[0]),
              "mqtt://hub:1883 closed the connection, and was not back in time; it may or may not have been "
              "executed");
}

TEST_F(CallTest, ConnectionThatIsBackInTime_BringsTheAnswer) {
    const auto call = write();
    lose();
    pass(2s);
    connect();
    answer(sent[0], {{"status", "ok"}});
    pass(1min);
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_TRUE(replies[0].succeeded());
}

TEST_F(CallTest, ConnectionThatEndsRightBehindTheCommand_IsPutDownToAccessRules) {
    const auto call = write();
    lose("closed", 1);
    connect();
    pass(5500ms);
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(replies[0].reason, "no-answer");
    EXPECT_THAT(replies[0].error, HasSubstr("right after a message on asip/uno1/servo/in"));
    EXPECT_TRUE(bus::may_have_been_executed(replies[0]));
}

TEST_F(CallTest, BrokerThatAcknowledgesNothing_IsSaidToStandStill) {
    unacknowledged = 1;
    const auto call = write();
    pass(5500ms);
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(replies[0].reason, "connection");
    EXPECT_THAT(replies[0].error, HasSubstr("stand still"));
}

TEST_F(CallTest, DeniedMessage_EndsTheCommandsOfItsTopicAtOnce) {
    const auto call = write();
    const auto other = command({.topic = "asip/uno2/servo/in", .payload = "W,0,90"});
    EXPECT_TRUE(caller->denied("asip/uno1/servo/in", "Not authorized"));
    EXPECT_FALSE(caller->denied("asip/uno3/servo/in", "Not authorized"));
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(replies[0].status, bus::Reply::Status::kRefused);
    EXPECT_EQ(replies[0].reason, "denied");
    EXPECT_THAT(replies[0].error, HasSubstr("does not let user ann write to asip/uno1/servo/in"));
    pass(5500ms);
    ASSERT_EQ(replies.size(), 2u);
    EXPECT_EQ(replies[1].reason, "no-answer");
}

TEST_F(CallTest, NoRoom_IsRefusedBehindTheCall) {
    room = false;
    const auto call = write();
    EXPECT_TRUE(replies.empty());
    pass(0ms);
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(replies[0].reason, "queue-full");
    EXPECT_FALSE(bus::may_have_been_executed(replies[0]));
    room = true;
    const auto next = write();
    answer(sent[0], {{"status", "ok"}});
    EXPECT_TRUE(replies.back().succeeded());
}

TEST_F(CallTest, AnswerOfAnotherBoard_IsNone) {
    const auto call = write();
    auto members = json::parse(sent[0].payload);
    receive("asip/reply/ann/uno2/me", json{{"status", "ok"}, {"id", members.at("id")}}.dump());
    EXPECT_TRUE(replies.empty());
    answer(sent[0], {{"status", "ok"}});
    EXPECT_EQ(replies.size(), 1u);
}

TEST_F(CallTest, AnswerThatCannotBeRead_ProvesNothing) {
    const auto call = write();
    answer(sent[0], {{"status", "of another version"}});
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(bus::sentence_of(replies[0]),
              "the answer cannot be read; it may or may not have been executed");
}

TEST_F(CallTest, HandleThatEnded_IsNotTold) {
    auto call = write();
    call.reset();
    answer(sent[0], {{"status", "ok"}});
    pass(1min);
    EXPECT_TRUE(replies.empty());
    call = write();
    caller.reset();
    call.reset();
}

TEST_F(CallTest, EndAll_AnswersEachOnce) {
    const auto call = write();
    const auto other = write();
    EXPECT_EQ(caller->waiting_topic(), "asip/uno1/servo/in");
    caller->end_all(bus::Reply::timeout(bus::kTimeoutConnection));
    answer(sent[0], {{"status", "ok"}});
    pass(1min);
    ASSERT_EQ(replies.size(), 2u);
    EXPECT_EQ(replies[1].reason, "connection");
    EXPECT_EQ(caller->waiting_topic(), "");
}

TEST_F(CallTest, CommandInsideAnAnswer_IsSent) {
    std::vector<Caller::Call> calls;
    const auto first = caller->command(
        {.topic = "asip/uno1/servo/in", .payload = "W,0,90"},
        [&](const bus::Reply&) { calls.push_back(write()); }, now);
    answer(sent[0], {{"status", "ok"}});
    ASSERT_EQ(sent.size(), 2u);
    answer(sent[1], {{"status", "ok"}});
    EXPECT_EQ(replies.size(), 1u);
}

TEST_F(CallTest, BoardOfNamesAlone_GetsTheLineAsItIs) {
    const auto call =
        command({.topic = "asip/pico/servo/in", .payload = "W,0,90", .plain = true, .by = "ann"});
    EXPECT_EQ(sent[0].payload, "W,0,90");
}

TEST_F(CallTest, WhoAsks_IsInThePayloadUnlessThatSaysIt) {
    for (const bool version5 : {true, false}) {
        v5 = version5;
        const auto line = command({.topic = "asip/uno1/servo/in", .payload = "W,0,90", .by = "ann"});
        EXPECT_EQ(json::parse(sent.back().payload).at("by"), "ann");
        const auto named = command({.topic = "asip/uno1/$stop", .payload = R"({"by":"bert"})", .by = "ann"});
        EXPECT_EQ(json::parse(sent.back().payload).at("by"), "bert");
    }
}

TEST_F(CallTest, IdAndReplyTopicsOfTheProgram_AreTaken) {
    const auto session = caller->replies().below("s1");
    const auto call =
        command({.topic = "asip/uno1/servo/in", .payload = "{}", .id = "s1.7", .replies = session});
    EXPECT_EQ(call.id(), "s1.7");
    EXPECT_EQ(sent[0].response_topic, "asip/reply/ann/uno1/me/s1");
    receive("asip/reply/ann/uno1/me", R"({"id":"s1.7","status":"ok"})");
    receive("asip/reply/ann/uno2/me/s1", R"({"id":"s1.7","status":"ok"})");
    EXPECT_TRUE(replies.empty()) << "other topics";
    answer(sent[0], {{"status", "ok"}}, "1f3c09aa-5000");
    EXPECT_EQ(replies.size(), 1u);
    const auto next = write();
    EXPECT_EQ(json::parse(sent[1].payload).at("clock"), "1f3c09aa-5001") << "of the same board";
}

TEST_F(CallTest, First_GoesAheadOfAllThatWaits) {
    const auto stop = command({.topic = "asip/uno1/$stop", .payload = "{}", .lasts = true, .first = true});
    EXPECT_TRUE(sent.empty());
    ASSERT_EQ(sent_first.size(), 1u);
    answer(sent_first[0], {{"status", "ok"}});
    EXPECT_EQ(replies.size(), 1u);
}

TEST_F(CallTest, LateAnswer_IsToldWhereItIsWanted) {
    const auto call =
        command({.topic = "asip/uno1/servo/in", .payload = "{}", .deadline = 300ms, .late = true});
    pass(800ms);
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(replies[0].reason, "no-answer");
    EXPECT_EQ(caller->waiting_topic(), "");
    EXPECT_FALSE(caller->denied("asip/uno1/servo/in", "Not authorized"));
    caller->end_all(bus::Reply::timeout());
    ASSERT_EQ(replies.size(), 1u);
    answer(sent[0], {{"status", "ok"}});
    answer(sent[0], {{"status", "error"}});
    ASSERT_EQ(replies.size(), 2u);
    EXPECT_TRUE(replies[1].succeeded());
}

TEST_F(CallTest, ManyThatWait_AreFoundEach) {
    std::vector<Caller::Call> calls;
    for (int i = 0; i < 1000; ++i) {
        calls.push_back(write());
        if (i % 3 == 0) calls.pop_back();
    }
    for (const auto& message : std::vector<mqtt::Message>(sent))
        answer(message, {{"status", "ok"}});
    EXPECT_EQ(replies.size(), calls.size());
}

TEST_F(CallTest, SecondCommand_SaysWhenItWasSentByTheAgentsClock) {
    const auto first = write();
    pass(10ms);
    answer(sent[0], {{"status", "ok"}}, "1f3c09aa-5000");
    pass(1s);
    const auto second = write();
    EXPECT_EQ(json::parse(sent[1].payload).at("clock"), "1f3c09aa-6011");
}

TEST_F(CallTest, Question_IsAnsweredByAnyNumber) {
    mqtt::Message question{.topic = "asip/registry/query", .payload = "{}"};
    int answers = 0;
    auto asked = caller->ask(std::move(question), [&](const mqtt::Message&) { ++answers; }, now);
    answer(sent[0], {});
    answer(sent[0], {});
    EXPECT_EQ(answers, 2);
    asked.reset();
    answer(sent[0], {});
    EXPECT_EQ(answers, 2);
}

}  // namespace
}  // namespace asip::caller
