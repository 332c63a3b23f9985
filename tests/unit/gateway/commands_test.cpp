// SPDX-License-Identifier: Apache-2.0
#include "gateway/commands/commands.hpp"

#include <gmock/gmock.h>

#include "clock.hpp"

namespace asip::gateway {
namespace {

class CommandsTest : public testing::Test {
  protected:
    Commands::Started send(const std::string& session, const std::string& id,
                           const std::string& payload = R"({"write":[0,90]})", bool v5 = true,
                           std::chrono::milliseconds time = 0ms) {
        commands_.tick(at(time));
        Commands::Start start{session, id, "anna", "uno1/servo", "asip/uno1/servo/in", payload, 1s};
        return commands_.start(
            start, v5, at(time), [this](const CommandRecord& record) { done_.push_back(record); }, message_);
    }
    mqtt::Message answer(const std::string& payload) {
        mqtt::Message reply;
        reply.topic = message_.response_topic;
        reply.correlation = message_.correlation;
        reply.payload = payload;
        return reply;
    }

    Commands commands_{bus::ReplyTopics(bus::Topics(), "gate", "gw")};
    mqtt::Message message_;
    std::vector<CommandRecord> done_;
};

TEST_F(CommandsTest, Sent_CarriesDeadlineReplyTopicOfTheSessionAndWhoSentIt) {
    ASSERT_EQ(send("s1", "7"), Commands::Started::kPublish);
    EXPECT_EQ(message_.topic, "asip/uno1/servo/in");
    EXPECT_EQ(
        message_.payload,
        R"({"clock":"","id":"s1.7","reply_to":"asip/reply/gate/uno1/gw/s1","write":[0,90],"deadline_ms":1000,"by":"anna"})")
        << "a bridge may drop the properties";
    EXPECT_EQ(message_.expiry_seconds, 1u);
    EXPECT_EQ(message_.response_topic, "asip/reply/gate/uno1/gw/s1");
    EXPECT_EQ(message_.user_properties,
              (std::vector<std::pair<std::string, std::string>>{{"by", "anna"}, {"clock", ""}}));
}

TEST_F(CommandsTest, AnswerToldTheClockOfTheAgent_TheNextCommandToldWhenItWasSent) {
    send("s1", "7");
    auto first = answer(R"({"id":"s1.7","status":"ok","proof":"fence"})");
    first.user_properties = {{"clock", "1f3c09aa-700000"}};
    ASSERT_TRUE(commands_.take(first, at(5ms)));
    EXPECT_EQ(done_[0].reply->clock, "");
    message_ = {};
    send("s2", "8");
    EXPECT_EQ(message_.user_properties.back(),
              (std::pair<std::string, std::string>{"clock", "1f3c09aa-700001"}));
}

TEST_F(CommandsTest, Urgent_ItsAnswerComesPastThoseOfOthers) {
    Commands::Start start{"stop", "", "anna", "uno1", "asip/uno1/$stop", "{}"};
    start.urgent = start.answer_first = true;
    ASSERT_EQ(
        commands_.start(
            start, true, at(0ms), [this](const CommandRecord& record) { done_.push_back(record); }, message_),
        Commands::Started::kPublish);
    EXPECT_EQ(message_.response_topic, "asip/reply/gate/uno1/gw-urgent/stop");
    EXPECT_EQ(message_.expiry_seconds, std::nullopt);
    EXPECT_TRUE(commands_.take(answer(R"({"status":"ok","proof":"fence"})"), at(5ms)));
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_TRUE(done_[0].reply->succeeded());
}

TEST_F(CommandsTest, AsManyKeptAsMayBe_OnlyWhatIsUrgentIsTaken) {
    for (std::size_t i = 0; i < Commands::kMaxRecords; ++i) {
        Commands::Start one{"s1", std::to_string(i), "anna", "uno1/servo", "asip/uno1/servo/in", "{}"};
        commands_.start(one, true, at(0ms), [](const CommandRecord&) {}, message_);
    }
    ASSERT_EQ(commands_.size(), Commands::kMaxRecords);
    EXPECT_EQ(send("s1", "one more"), Commands::Started::kTooMany);
    Commands::Start start{"stop", "", "anna", "uno1", "asip/uno1/$stop", "{}"};
    start.urgent = true;
    EXPECT_EQ(commands_.start(
                  start, true, at(0ms), [](const CommandRecord&) {}, message_),
              Commands::Started::kPublish);
}

TEST_F(CommandsTest, OverMqtt311_ReplyTopicAndIdAreInThePayload) {
    ASSERT_EQ(send("s1", "7", R"({"write":[0,90]})", false), Commands::Started::kPublish);
    EXPECT_THAT(message_.payload, testing::HasSubstr(R"("reply_to":"asip/reply/gate/uno1/gw/s1")"));
    mqtt::Message reply;
    reply.topic = "asip/reply/gate/uno1/gw/s1";
    reply.payload = R"({"id":"s1.7","status":"ok","proof":"fence"})";
    EXPECT_TRUE(commands_.take(reply, at(5ms)));
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_EQ(done_[0].reply->id, "7");
}

TEST_F(CommandsTest, Answered_OnceAndKeptAMinute) {
    send("s1", "7");
    EXPECT_TRUE(commands_.take(answer(R"({"status":"ok","proof":"fence"})"), at(5ms)));
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_TRUE(done_[0].reply->succeeded());
    EXPECT_TRUE(commands_.take(answer(R"({"status":"timeout"})"), at(6ms)));
    EXPECT_EQ(done_.size(), 1u);
    commands_.tick(at(60s));
    EXPECT_TRUE(commands_.find("s1", "7")->reply->succeeded());
    commands_.tick(at(61s));
    EXPECT_EQ(commands_.find("s1", "7"), nullptr);
}

TEST_F(CommandsTest, SameIdInTwoSessions_AreTwoCommands) {
    EXPECT_EQ(send("s1", "7"), Commands::Started::kPublish);
    const auto first = message_.correlation;
    EXPECT_EQ(send("s2", "7"), Commands::Started::kPublish);
    EXPECT_NE(message_.correlation, first);
    EXPECT_EQ(message_.response_topic, "asip/reply/gate/uno1/gw/s2");
}

TEST_F(CommandsTest, Repeated_IsNotPublishedAgainAndGetsTheSameAnswer) {
    send("s1", "7");
    EXPECT_EQ(send("s1", "7"), Commands::Started::kRepeated);
    EXPECT_TRUE(done_.empty());
    commands_.take(answer(R"({"status":"ok"})"), at(5ms));
    EXPECT_EQ(done_.size(), 2u) << "both who wait";
    EXPECT_EQ(send("s1", "7"), Commands::Started::kRepeated);
    EXPECT_EQ(done_.size(), 3u) << "at once";
}

TEST_F(CommandsTest, SameIdAnotherCommand_IsRefused) {
    send("s1", "7");
    EXPECT_EQ(send("s1", "7", R"({"write":[0,91]})"), Commands::Started::kIdReused);
}

TEST_F(CommandsTest, Refused_IsNotRememberedAndTheSameAgainIsSent) {
    int before = 0;
    commands_.before_again = [&] { ++before; };
    send("s1", "7");
    commands_.take(answer(R"({"status":"refused","reason":"queue-full"})"), at(5ms));
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_EQ(commands_.find("s1", "7")->reply->reason, "queue-full") << "and yet it can be asked for";
    EXPECT_EQ(send("s1", "7"), Commands::Started::kPublish);
    EXPECT_EQ(before, 1);
    EXPECT_FALSE(commands_.find("s1", "7")->reply) << "under way";
    commands_.take(answer(R"({"status":"ok"})"), at(6ms));
    EXPECT_TRUE(done_.back().reply->succeeded());
    commands_.tick(at(61s));
    EXPECT_EQ(commands_.size(), 0u);
}

TEST_F(CommandsTest, NotPublished_IsRefusedAtOnce) {
    Commands::Start start{"s1", "", "anna", "uno1/servo", "asip/uno1/servo/in", "{}"};
    commands_.start(
        start, true, at(0ms), [this](const CommandRecord& record) { done_.push_back(record); }, message_);
    commands_.not_published(start, at(0ms));
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_EQ(done_[0].reply->reason, "queue-full");
    EXPECT_EQ(done_[0].reply->by, "anna");
    EXPECT_EQ(commands_.counters().refused, 1u);
    EXPECT_EQ(commands_.find("s1", start.id)->reply->reason, "queue-full");
}

TEST_F(CommandsTest, NobodyAnswers_TimeoutAndALateAnswerIsStillKept) {
    send("s1", "7");
    commands_.tick(at(1499ms));
    EXPECT_TRUE(done_.empty());
    commands_.tick(at(1500ms));
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_EQ(done_[0].reply->reason, "no-answer");
    EXPECT_TRUE(commands_.take(answer(R"({"status":"ok","proof":"fence"})"), at(3s)));
    EXPECT_EQ(done_.size(), 1u) << "one answer, in time";
    EXPECT_TRUE(commands_.find("s1", "7")->late);
    EXPECT_TRUE(commands_.find("s1", "7")->reply->succeeded());
    EXPECT_EQ(commands_.counters().timeout, 1u);
    EXPECT_EQ(commands_.counters().ok, 0u);
}

TEST_F(CommandsTest, AnswerOfAnotherSession_IsNotTaken) {
    send("s1", "7");
    auto forged = answer(R"({"status":"ok"})");
    forged.topic = "asip/reply/gate/uno1/gw/s2";
    EXPECT_FALSE(commands_.take(forged, at(5ms)));
    forged.topic = "asip/reply/gate/uno2/gw/s1";
    EXPECT_FALSE(commands_.take(forged, at(5ms))) << "another board";
    EXPECT_FALSE(commands_.take(answer("nonsense"), at(5ms)));
    EXPECT_TRUE(done_.empty());
    EXPECT_TRUE(commands_.take(answer(R"({"status":"ok"})"), at(5ms)));
}

TEST(CommandStatus, EachAnswerOfTheBus_HasOneInHttp) {
    using bus::Reply;
    EXPECT_EQ(http_status(Reply::ok("fence")), 200);
    EXPECT_EQ(http_status(Reply::board_error(7, "x")), 422);
    EXPECT_EQ(http_status(Reply::timeout()), 504);
    EXPECT_EQ(http_status(Reply::timeout(bus::kTimeoutDoubt)), 504);
    EXPECT_EQ(http_status(Reply::refused("invalid", "x")), 400);
    EXPECT_EQ(http_status(Reply::refused("queue-full", "x")), 429);
    EXPECT_EQ(http_status(Reply::refused("board-not-there", "x")), 503);
    EXPECT_EQ(http_status(Reply::refused("id-reused", "x")), 409);
    EXPECT_EQ(http_status(Reply::refused("stopped", "x")), 409);
}

}  // namespace
}  // namespace asip::gateway
