// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/requester.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include <optional>
#include <vector>

namespace asip::bus {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

mqtt::Message message(std::string topic, std::string payload, std::string correlation = {}) {
    return mqtt::Message{
        .topic = std::move(topic), .payload = std::move(payload), .correlation = std::move(correlation)};
}

constexpr const char* kReply = "asip/reply/ann/uno1/me";

class RequesterTest : public testing::Test {
  protected:
    Requester::Request ask(std::string payload, bool v5, const std::string& name) {
        sent = message("asip/uno1/servo/in", std::move(payload));
        return requester.ask(sent, v5, [this, name](const mqtt::Message& reply) {
            heard.push_back(name + ":" + reply.payload);
        });
    }
    Requester requester{"me", ReplyTopics(Topics("asip"), "ann", "me")};
    mqtt::Message sent;
    std::vector<std::string> heard;
};

TEST_F(RequesterTest, MembersOfTheAsker_AreThoseOfTheRequest) {
    const auto a = ask(R"( {"id":7,"wri\u0074e":[0, 90],"reply_to":"x","clock":"y"} )", true, "a");
    EXPECT_EQ(sent.payload,
              R"({"clock":"","id":"me-1","reply_to":"asip/reply/ann/uno1/me","wri\u0074e":[0, 90]})");
    const auto b = ask("{}", true, "b");
    EXPECT_EQ(sent.payload, R"({"clock":"","id":"me-2","reply_to":"asip/reply/ann/uno1/me"})");
}

TEST_F(RequesterTest, WhatIsNoJsonObject_IsALine) {
    for (const std::string payload :
         {"{", "[1]", "{\"a\":1}x", "{\"a\":1e999}", "{\"id\":7", "W,\"0\"", ""}) {
        const auto a = ask(payload, true, "a");
        EXPECT_EQ(nlohmann::json::parse(sent.payload).at("raw"), payload);
    }
}

TEST_F(RequesterTest, OnVersion5_AnswersAreFoundByCorrelation) {
    const auto a = ask("W,0,90", true, "a");
    EXPECT_EQ(sent.payload, R"({"clock":"","id":"me-1","reply_to":"asip/reply/ann/uno1/me","raw":"W,0,90"})")
        << "a bridge may drop the properties";
    EXPECT_EQ(sent.response_topic, kReply);
    EXPECT_EQ(requester.replies().filter(), "asip/reply/ann/+/me");
    const auto id_of_a = sent.correlation;
    const auto b = ask("W,0,91", true, "b");
    EXPECT_NE(sent.correlation, id_of_a);
    EXPECT_TRUE(requester.take(message(kReply, "2", sent.correlation)));
    EXPECT_TRUE(requester.take(message(kReply, "1", id_of_a)));
    EXPECT_TRUE(requester.take(message(kReply, "?", "stranger")));
    EXPECT_FALSE(requester.take(message("asip/reply/ann/uno1/you", "x", id_of_a)));
    EXPECT_FALSE(requester.take(message("asip/reply/you/uno1/me", "x", id_of_a)));
    EXPECT_THAT(heard, ElementsAre("b:2", "a:1"));
}

TEST_F(RequesterTest, BridgeDropsTheProperties_AnswerIsFoundByItsIdAndTellsTheClock) {
    const Time began = Time(100s);
    const auto a =
        requester.ask(sent = message("asip/uno1/in", "#,?"), true,
                      [this](auto& reply) { heard.push_back(reply.payload); }, began, {.deadline = 300ms});
    EXPECT_EQ(
        sent.payload,
        R"({"clock":"","id":"me-1","reply_to":"asip/reply/ann/uno1/me","deadline_ms":300,"raw":"#,?"})");
    EXPECT_TRUE(
        requester.take(message(kReply, R"({"clock":"1f3c09aa-700000","id":"me-1","status":"ok"})"), began));
    EXPECT_EQ(heard.size(), 1u);
    const auto b = requester.ask(sent = message("asip/uno1/in", "#,?"), true, [](auto&) {}, began + 1s);
    EXPECT_EQ(sent.user_properties.at(0).second, "1f3c09aa-701001");
}

TEST_F(RequesterTest, BoardWithoutAnAgent_GetsPlainLines) {
    const auto a =
        requester.ask(sent = message("asip/uno1/in", "#,?"), true, [](auto&) {}, Time(1s), {.plain = true});
    EXPECT_EQ(sent.payload, "#,?");
}

TEST_F(RequesterTest, DeadlineOfThePayload_Stays) {
    const auto a = requester.ask(sent = message("asip/uno1/in", R"({"deadline_ms":70})"), true, [](auto&) {},
                                 Time(1s), {.deadline = 5s});
    EXPECT_THAT(sent.payload, testing::HasSubstr(R"("deadline_ms":70)"));
}

TEST_F(RequesterTest, OnVersion311_RequestAndAnswerCarryTheIdInTheirText) {
    const auto a = ask(R"({"write":[0,90]})", false, "a");
    EXPECT_EQ(sent.payload, R"({"clock":"","id":"me-1","reply_to":"asip/reply/ann/uno1/me","write":[0,90]})");
    EXPECT_TRUE(sent.response_topic.empty());
    const auto b = ask("W,0,90", false, "b");
    EXPECT_EQ(sent.payload, R"({"clock":"","id":"me-2","reply_to":"asip/reply/ann/uno1/me","raw":"W,0,90"})");
    requester.take(message(kReply, R"({"status":"ok","id":"me-2"})"));
    requester.take(message(kReply, R"({"id":7})"));
    requester.take(message(kReply, "nonsense"));
    requester.take(message(kReply, R"({"nested":{"id":"me-1"}})"));
    EXPECT_THAT(heard, ElementsAre(R"(b:{"status":"ok","id":"me-2"})"));
}

TEST_F(RequesterTest, AnswerOnTheTopicOfAnotherBoard_IsNone) {
    const auto a = ask("W,0,90", true, "a");
    EXPECT_TRUE(requester.take(message("asip/reply/ann/uno2/me", "forged", sent.correlation)));
    EXPECT_TRUE(requester.take(message("asip/reply/ann/$self/me", "forged", sent.correlation)));
    EXPECT_TRUE(heard.empty());
    EXPECT_TRUE(requester.take(message(kReply, "true", sent.correlation)));
    EXPECT_THAT(heard, ElementsAre("a:true"));
}

// --- the agent's clock

using Properties = std::vector<std::pair<std::string, std::string>>;

TEST_F(RequesterTest, OnVersion5_CommandTellsWhenItWasSentByTheClockOfTheLastAnswer) {
    const Time began = Time(100s);
    const auto first = requester.ask(sent = message("asip/uno1/in", "#,?"), true, [](auto&) {}, began);
    EXPECT_EQ(sent.user_properties, (Properties{{"clock", ""}}));
    auto answer = message(kReply, "{}", sent.correlation);
    answer.user_properties = {{"by", "me"}, {"clock", "1f3c09aa-700000"}};
    requester.take(answer, began + 10ms);
    const auto second =
        requester.ask(sent = message("asip/uno1/servo/in", "W,0,90"), true, [](auto&) {}, began + 1s);
    EXPECT_EQ(sent.user_properties, (Properties{{"clock", "1f3c09aa-701001"}}));
    EXPECT_THAT(sent.payload, testing::HasSubstr(R"("clock":"1f3c09aa-701001")"));
    const auto other =
        requester.ask(sent = message("asip/uno2/servo/in", "W,0,90"), true, [](auto&) {}, began + 1s);
    EXPECT_EQ(sent.user_properties, (Properties{{"clock", ""}})) << "another board, another agent";
}

TEST_F(RequesterTest, OnVersion311_ClockTravelsInTheText) {
    const Time began = Time(100s);
    const auto first = requester.ask(sent = message("asip/uno1/in", "#,?"), false, [](auto&) {}, began);
    requester.take(message(kReply, R"({"answer":{"clock":"no"},"clock":"1f3c09aa-700000","id":"me-1"})"),
                   began);
    const auto second = requester.ask(sent = message("asip/uno1/in", "#,?"), false, [](auto&) {}, began);
    EXPECT_EQ(sent.payload,
              R"({"clock":"1f3c09aa-700001","id":"me-2","reply_to":"asip/reply/ann/uno1/me","raw":"#,?"})");
}

TEST_F(RequesterTest, WhatIsNoCommand_AsksForNoClock) {
    const auto query = requester.ask(sent = message("asip/registry/query", "{}"), true, [](auto&) {});
    EXPECT_TRUE(sent.user_properties.empty());
    const auto old = requester.ask(sent = message("asip/registry/query", "{}"), false, [](auto&) {});
    EXPECT_EQ(sent.payload, R"({"id":"me-2","reply_to":"asip/reply/ann/registry/me"})");
}

TEST_F(RequesterTest, RequestEnded_ItsAnswerIsIgnored) {
    auto a = ask("x", true, "a");
    const auto correlation = sent.correlation;
    a.reset();
    EXPECT_TRUE(requester.take(message(kReply, "late", correlation)));
    EXPECT_TRUE(heard.empty());
}

TEST_F(RequesterTest, RequestEndsInsideItsOwnCallback_IsHarmless) {
    std::optional<Requester::Request> own;
    std::string seen;
    sent = message("asip/uno1/in", "x");
    own = requester.ask(sent, true, [&, text = std::string(100, 'y')](const mqtt::Message&) {
        own.reset();
        seen = text;
    });
    requester.take(message(kReply, "1", sent.correlation));
    EXPECT_EQ(seen, std::string(100, 'y'));
}

TEST(Request, OutlivesItsRequester_IsHarmless) {
    Requester::Request left;
    {
        Requester requester("me", ReplyTopics(Topics(), "", "r"));
        auto sent = message("t", "x");
        left = requester.ask(sent, true, [](const mqtt::Message&) { FAIL(); });
    }
    EXPECT_EQ(left.id(), "me-1");
    left.reset();
    EXPECT_EQ(left.id(), "");
}

}  // namespace
}  // namespace asip::bus
