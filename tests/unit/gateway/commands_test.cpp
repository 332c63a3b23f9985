// SPDX-License-Identifier: Apache-2.0
#include "gateway/commands/commands.hpp"

#include <gmock/gmock.h>

#include "clock.hpp"

namespace asip::gateway {
namespace {

class CommandsTest : public testing::Test {
  protected:
    caller::Caller::Port port() {
        caller::Caller::Port port;
        port.publish = [this](mqtt::Message message) {
            message_ = std::move(message);
            return true;
        };
        port.publish_first = [this](mqtt::Message message) {
            message_ = std::move(message);
            ++first_;
            return true;
        };
        port.subscribe = [](const std::string&, mqtt::SubscribeOptions) {};
        port.v5 = [] { return true; };
        return port;
    }
    void tick(std::chrono::milliseconds time) {
        now_ = at(time);
        caller_.tick(now_.time);
        commands_.tick(now_.time);
    }
    Commands::Started start(Commands::Start start) {
        return commands_.start(start, now_, [this](const CommandRecord& record) { done_.push_back(record); });
    }
    Commands::Started send(const std::string& session, const std::string& id,
                           const std::string& payload = R"({"write":[0,90]})") {
        return start({session, id, "anna", "uno1/servo", "asip/uno1/servo/in", payload, 1s});
    }
    mqtt::Message answer(const std::string& payload) {
        return mqtt::Message{
            .topic = message_.response_topic, .payload = payload, .correlation = message_.correlation};
    }
    bool take(const mqtt::Message& message, std::chrono::milliseconds time) {
        now_ = at(time);
        return caller_.message(message, now_.time);
    }

    Instant now_ = at(0ms);
    mqtt::Message message_;  // the last one
    int first_ = 0;          // ahead of all that waits
    std::vector<CommandRecord> done_;
    caller::Caller caller_{{bus::Topics(), "gate", "gw"}, [] { return 7u; }, port()};
    Commands commands_{caller_};
};

TEST_F(CommandsTest, Sent_CarriesDeadlineReplyTopicOfTheSessionAndWhoSentIt) {
    ASSERT_EQ(send("s1", "7"), Commands::Started::kSent);
    EXPECT_EQ(message_.topic, "asip/uno1/servo/in");
    EXPECT_EQ(
        message_.payload,
        R"({"clock":"","id":"s1.7","reply_to":"asip/reply/gate/uno1/gw/s1","deadline_ms":1000,"by":"anna","write":[0,90]})");
    EXPECT_EQ(message_.expiry_seconds, 1u);
    EXPECT_EQ(message_.response_topic, "asip/reply/gate/uno1/gw/s1");
}

TEST_F(CommandsTest, AnswerInOneSessionToldTheClockOfTheAgent_TheCommandOfAnotherToldWhenItWasSent) {
    send("s1", "7");
    auto first = answer(R"({"id":"s1.7","status":"ok","proof":"fence","clock":"1f3c09aa-700000"})");
    first.user_properties = {{"clock", "1f3c09aa-700000"}};
    ASSERT_TRUE(take(first, 5ms));
    EXPECT_EQ(done_[0].reply->clock, "");
    send("s2", "8");
    EXPECT_EQ(message_.user_properties.back(),
              (std::pair<std::string, std::string>{"clock", "1f3c09aa-700006"}));
}

TEST_F(CommandsTest, Urgent_ItsAnswerComesPastThoseOfOthers) {
    Commands::Start stop{"stop", "", "anna", "uno1", "asip/uno1/$stop", "{}"};
    stop.urgent = stop.answer_first = true;
    ASSERT_EQ(start(std::move(stop)), Commands::Started::kSent);
    EXPECT_EQ(first_, 1);
    EXPECT_EQ(message_.response_topic, "asip/reply/gate/uno1/gw-urgent/stop");
    EXPECT_EQ(message_.expiry_seconds, std::nullopt);
    EXPECT_TRUE(take(answer(R"({"status":"ok","proof":"fence"})"), 5ms));
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_TRUE(done_[0].reply->succeeded());
}

TEST_F(CommandsTest, AsManyKeptAsMayBe_OnlyWhatIsUrgentIsTaken) {
    for (std::size_t i = 0; i < Commands::kMaxRecords; ++i)
        ASSERT_EQ(send("s1", std::to_string(i)), Commands::Started::kSent);
    ASSERT_EQ(commands_.size(), Commands::kMaxRecords);
    EXPECT_EQ(send("s1", "one more"), Commands::Started::kTooMany);
    Commands::Start stop{"stop", "", "anna", "uno1", "asip/uno1/$stop", "{}"};
    stop.urgent = true;
    EXPECT_EQ(start(std::move(stop)), Commands::Started::kSent);
}

TEST_F(CommandsTest, Answered_OnceAndKeptAMinute) {
    send("s1", "7");
    EXPECT_TRUE(take(answer(R"({"status":"ok","proof":"fence"})"), 5ms));
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_TRUE(done_[0].reply->succeeded());
    take(answer(R"({"status":"timeout"})"), 6ms);
    EXPECT_EQ(done_.size(), 1u);
    tick(60s);
    EXPECT_TRUE(commands_.find("s1", "7")->reply->succeeded());
    tick(61s);
    EXPECT_EQ(commands_.find("s1", "7"), nullptr);
}

TEST_F(CommandsTest, SameIdInTwoSessions_AreTwoCommands) {
    EXPECT_EQ(send("s1", "7"), Commands::Started::kSent);
    const auto first = message_.correlation;
    EXPECT_EQ(send("s2", "7"), Commands::Started::kSent);
    EXPECT_NE(message_.correlation, first);
    EXPECT_EQ(message_.response_topic, "asip/reply/gate/uno1/gw/s2");
}

TEST_F(CommandsTest, Repeated_IsNotPublishedAgainAndGetsTheSameAnswer) {
    send("s1", "7");
    EXPECT_EQ(send("s1", "7"), Commands::Started::kRepeated);
    EXPECT_TRUE(done_.empty());
    take(answer(R"({"status":"ok"})"), 5ms);
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
    take(answer(R"({"status":"refused","reason":"queue-full"})"), 5ms);
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_EQ(commands_.find("s1", "7")->reply->reason, "queue-full") << "and yet it can be asked for";
    EXPECT_EQ(send("s1", "7"), Commands::Started::kSent);
    EXPECT_EQ(before, 1);
    EXPECT_FALSE(commands_.find("s1", "7")->reply) << "under way";
    take(answer(R"({"status":"ok"})"), 6ms);
    EXPECT_TRUE(done_.back().reply->succeeded());
    tick(61s);
    EXPECT_EQ(commands_.size(), 0u);
}

TEST_F(CommandsTest, NobodyAnswers_TimeoutAndALateAnswerIsStillKept) {
    send("s1", "7");
    tick(1499ms);
    EXPECT_TRUE(done_.empty());
    tick(1500ms);
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_EQ(done_[0].reply->reason, "no-answer");
    EXPECT_TRUE(take(answer(R"({"status":"ok","proof":"fence"})"), 3s));
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
    EXPECT_FALSE(take(forged, 5ms));
    forged.topic = "asip/reply/gate/uno2/gw/s1";
    EXPECT_FALSE(take(forged, 5ms)) << "another board";
    EXPECT_TRUE(done_.empty());
    EXPECT_TRUE(take(answer(R"({"status":"ok"})"), 5ms));
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
