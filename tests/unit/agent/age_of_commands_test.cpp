// SPDX-License-Identifier: Apache-2.0
// Commands that say when they were sent, by the agent's own clock.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

struct AgeOfCommands : OnlineBridge {
    AgeOfCommands() {
        bench.pass(60s);
        sent = bench.ask("asip/uno1/in", {{"raw", "#,?"}, {"clock", ""}})["clock"];
        bench.published.clear();
        bench.board.executed.clear();
    }
    json ask(json command, const std::string& topic = "asip/uno1/servo/in") {
        command["clock"] = sent;
        bench.ask(topic, std::move(command), std::to_string(++ids));
        return answer();
    }
    json answer() {
        bench.pass(1ms);  // what is too old to be sent ends with the next tick
        const auto answers = bench.on("answers");
        return answers.empty() ? json() : json::parse(answers.back());
    }
    static mqtt::Message over_mqtt5(const std::string& payload,
                                    decltype(mqtt::Message::user_properties) properties) {
        return mqtt::Message{.topic = "asip/uno1/servo/in",
                             .payload = payload,
                             .response_topic = "answers",
                             .correlation = "c",
                             .user_properties = std::move(properties)};
    }
    std::string sent;  // what the agent's clock showed then
    int ids = 1;
};

TEST_F(AgeOfCommands, DelayedForLongerThanItsDeadline_IsRefused) {
    bench.pass(4900ms);
    EXPECT_EQ(ask({{"write", {0, 10}}})["status"], "ok");
    bench.pass(200ms);
    const auto answer = ask({{"write", {0, 90}}});
    EXPECT_EQ(answer["status"], "refused");
    EXPECT_EQ(answer["reason"], "deadline");
    EXPECT_EQ(ask({{"write", {0, 20}}, {"deadline_ms", 10'000}})["status"], "ok");
    EXPECT_EQ(ask({{"write", {0, 90}}, {"deadline_ms", 1'000}})["reason"], "deadline");
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,10", "S,W,0,20"));
}

TEST_F(AgeOfCommands, RefusedAndDeliveredAgain_IsRefusedAgainAndATryOfLaterIsNot) {
    const auto deliver = [&](const std::string& clock) {
        bench.ask("asip/uno1/servo/in", {{"write", {0, 10}}, {"clock", clock}}, "same");
        return answer();
    };
    bench.unplug();
    EXPECT_EQ(deliver(sent)["reason"], "board-not-there");
    bench.plug();
    bench.pass(3s);
    const auto copy = deliver(sent);
    EXPECT_EQ(copy["status"], "refused");
    EXPECT_EQ(copy["reason"], "board-not-there");
    EXPECT_THAT(bench.board.executed, testing::Not(testing::Contains("S,W,0,10")));
    EXPECT_EQ(deliver(copy["clock"])["status"], "ok");
}

TEST_F(AgeOfCommands, RefusedByAStopAndDeliveredAgain_IsRefusedAgain) {
    const auto message = over_mqtt5("W,0,10", {{"clock", sent}});
    bench.hear(message, bench.now, true);
    EXPECT_EQ(answer()["reason"], "stopped");
    bench.hear(message);
    EXPECT_EQ(answer()["reason"], "stopped");
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_F(AgeOfCommands, WithAnExpiry_WhatIsLeftOfItCountsFromTheArrival) {
    auto message = over_mqtt5(R"({"write":[0,10],"deadline_ms":5000})", {{"clock", sent}});
    const auto hear = [&](unsigned left, const char* id) {
        message.expiry_seconds = left;
        message.correlation = id;
        bench.hear(message);
        return answer()["status"];
    };
    bench.pass(4s);
    EXPECT_EQ(hear(1, "a"), "ok");
    bench.pass(1100ms);
    EXPECT_EQ(hear(5, "b"), "refused") << "a bridge may have begun the expiry anew";
}

TEST_F(AgeOfCommands, OverMqtt5_ClockComesAndGoesAsUserProperty) {
    auto message = over_mqtt5("W,0,10", {{"by", "ann"}, {"clock", ""}});
    bench.hear(message);
    ASSERT_EQ(bench.published.front().message.topic, "answers");
    const auto& first = bench.published.front().message;
    EXPECT_FALSE(json::parse(first.payload).contains("clock"));
    ASSERT_EQ(first.user_properties.size(), 1u);
    message.user_properties = {first.user_properties.front()};
    message.correlation = "d";
    bench.pass(6s);
    bench.hear(message);
    EXPECT_EQ(answer()["reason"], "deadline");
}

TEST_F(AgeOfCommands, NoReadingOrOneOfAnotherStart_CountsFromTheArrival) {
    bench.pass(60s);
    for (const std::string reading : {"", "nonsense", "ffffffff-1", "0-0"}) {
        sent = reading;
        const auto answer = ask({{"write", {0, 10}}});
        EXPECT_EQ(answer["status"], "ok") << reading;
        EXPECT_TRUE(answer.contains("clock")) << reading;
    }
    EXPECT_EQ(bench.board.executed.size(), 4u);
    EXPECT_FALSE(bench.ask("asip/uno1/servo/in", {{"write", {0, 10}}}, "none").contains("clock"));
    const auto number = bench.ask("asip/uno1/servo/in", {{"write", {0, 10}}, {"clock", 7}}, "number");
    EXPECT_EQ(number["reason"], "invalid");
}

TEST_F(AgeOfCommands, ReadingFromTheFuture_CountsFromTheArrival) {
    sent = sent.substr(0, 9) + "3999999999999";
    bench.board.mute = true;
    ask({{"write", {0, 10}}});
    bench.pass(5100ms);
    EXPECT_EQ(json::parse(bench.on("answers").back())["status"], "timeout");
}

TEST_F(AgeOfCommands, Refusal_TellsTheClockOfNow) {
    bench.pass(70s);
    const auto late = ask({{"write", {0, 90}}});
    EXPECT_EQ(late["reason"], "deadline");
    sent = late["clock"];
    EXPECT_EQ(ask({{"write", {0, 10}}})["status"], "ok");
}

TEST_F(AgeOfCommands, Hold_IsInForceFromWhenItsCommandWasSent) {
    bench.pass(300ms);
    EXPECT_EQ(ask({{"write", {13, 1}}, {"hold_ms", 500}}, "asip/uno1/io/in")["status"], "ok");
    bench.pass(150ms);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,d,13,1"));
    bench.pass(60ms);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,d,13,1", "I,d,13,0"));
    bench.board.executed.clear();
    EXPECT_EQ(ask({{"write", {13, 1}}, {"hold_ms", 500}}, "asip/uno1/io/in")["reason"], "deadline");
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_F(AgeOfCommands, PortAskedForTooLongAgo_IsNotLetGo) {
    bench.pass(6s);
    EXPECT_EQ(ask({{"port", "release"}, {"by", "ann"}}, "asip/uno1/in")["status"], "timeout");
    EXPECT_EQ(bench.port, Effects::Port::kKeep);
}

}  // namespace
}  // namespace asip::agent
