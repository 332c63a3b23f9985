// SPDX-License-Identifier: Apache-2.0
#include "registry/query_endpoint.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "messages.hpp"

namespace asip::registry {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class HistoryQuestion : public testing::Test {
  protected:
    /// What a registry with or without a history answers at once, and what later.
    struct Answers {
        std::vector<std::string> at_once, later;
    };
    Answers ask(bool keeps_history, bool to_any) {
        Catalogue catalogue;
        Queries::Dependencies dependencies{
            catalogue, [] { return instant(at(0s)); }, [] { return 0; }, {}, {}};
        if (keeps_history)
            dependencies.history = [](const bus::Query&, const Queries::Done& done) { done({}); };
        Queries queries("r1", dependencies);
        std::vector<std::string> said;
        QueryEndpoint endpoint(
            queries,
            [&said](const mqtt::Message& answer) {
                said.push_back(nlohmann::json::parse(answer.payload).value("refused", "kept"));
            },
            [](const std::string&) { return true; });
        mqtt::Message question{.payload = R"({"find":"history","board":"uno1"})",
                               .response_topic = "answers"};
        endpoint.request(question, to_any, at(0s));
        Answers answers;
        answers.at_once = std::exchange(said, {});
        endpoint.tick(at(499ms));
        EXPECT_THAT(said, IsEmpty());
        endpoint.tick(at(500ms));
        endpoint.tick(at(600ms));
        answers.later = said;
        return answers;
    }
};

TEST(RequestToForget, WhereTheBrokerKnowsUsers_ComesByItsOwnTopicAlone) {
    Catalogue catalogue;
    catalogue.apply({bus::TopicKind::kState, "uno1", "lost", false, std::nullopt}, at(0s));
    Queries queries(
        "r1",
        {catalogue, [] { return instant(at(0s)); }, [] { return 0; }, [](const std::vector<Event>&) {}, {}});
    std::vector<std::string> said;
    QueryEndpoint endpoint(
        queries, [&said](const mqtt::Message& answer) { said.push_back(answer.payload); },
        [](const std::string&) { return true; });
    endpoint.set_forget_topic("asip/registry/r1/forget");
    mqtt::Message question;
    question.response_topic = "answers";
    const auto ask = [&](const std::string& text, bool to_forget) {
        said.clear();
        question.payload = text;
        to_forget ? endpoint.forget(question) : endpoint.request(question, false, at(0s));
        return said.empty() ? std::string() : said.front();
    };
    EXPECT_THAT(ask(R"({"forget":"uno1"})", false), HasSubstr("asip/registry/r1/forget"));
    EXPECT_THAT(ask(R"({"forget":"uno1","dry_run":true})", false), HasSubstr("uno1"));
    EXPECT_THAT(ask(R"({"find":"boards"})", true), HasSubstr("invalid"));
    EXPECT_THAT(ask("{", true), HasSubstr("invalid"));
    EXPECT_EQ(catalogue.size(), 1u);
    EXPECT_THAT(ask(R"({"forget":"uno1"})", true), HasSubstr(R"("forgotten":["uno1"])"));
    EXPECT_EQ(catalogue.size(), 0u);
}

TEST(QueryEndpointTest, AskerThatWasRefusedOften_IsNotReadUntilTheNextTick_AndOthersAre) {
    Catalogue catalogue;
    Queries queries("r1", {catalogue, [] { return instant(at(0s)); }, [] { return 0; }, {}, {}});
    std::size_t answers = 0, read = 0;
    QueryEndpoint endpoint(
        queries, [&answers](const mqtt::Message&) { ++answers; },
        [&read](const std::string&) { return ++read > 0; });
    const auto ask = [&](const std::string& user) {
        endpoint.request(
            {.payload = R"({"find":"boards","reply_to":"asip/reply/)" + user + R"(/registry/c"})"}, false,
            at(0s));
    };
    for (int i = 0; i < 1000; ++i)
        ask("eve");
    constexpr std::size_t kRead = QueryEndpoint::kAtOnce + 32 + 64;  // answered, waiting, refused
    EXPECT_EQ(read, kRead);
    EXPECT_EQ(answers, QueryEndpoint::kAtOnce + 64);
    ask("bob");
    EXPECT_EQ(read, kRead + 1);
    endpoint.tick(at(100ms));
    ask("eve");
    EXPECT_EQ(read, kRead + 2);
}

TEST(QueryEndpointTest, BrokerTakesNoAnswers_QuestionsWait_AlsoThroughTicks) {
    Catalogue catalogue;
    Queries queries("r1", {catalogue, [] { return instant(at(0s)); }, [] { return 0; }, {}, {}});
    std::size_t answers = 0;
    bool takes = true;
    QueryEndpoint endpoint(
        queries, [&answers](const mqtt::Message&) { ++answers; }, [](const std::string&) { return true; },
        [&takes] { return takes; });
    const mqtt::Message question{.payload = R"({"find":"boards"})", .response_topic = "answers"};
    endpoint.request(question, false, at(0s));
    takes = false;
    endpoint.request(question, false, at(0s));
    endpoint.tick(at(100ms));
    EXPECT_FALSE(endpoint.waits());
    EXPECT_EQ(answers, 1u);
    takes = true;
    ASSERT_TRUE(endpoint.waits());
    endpoint.turn();
    EXPECT_EQ(answers, 2u);
}

TEST_F(HistoryQuestion, ToEveryRegistry_IsAnsweredFirstByTheOneThatKeepsAHistory) {
    EXPECT_THAT(ask(true, true).at_once, ElementsAre("kept"));
    const auto without = ask(false, true);
    EXPECT_THAT(without.at_once, IsEmpty());
    EXPECT_THAT(without.later, ElementsAre("no-history"));
}

TEST_F(HistoryQuestion, ToOneThatKeepsNone_IsRefusedAtOnce) {
    const auto answers = ask(false, false);
    EXPECT_THAT(answers.at_once, ElementsAre("no-history"));
    EXPECT_THAT(answers.later, IsEmpty());
}

TEST(AskerTurnsTest, AskersTakeTurns_AndWhoAsksMuchWaitsForItself) {
    bus::AskerTurns<std::string> waiting;
    for (int i = 0; i < 3; ++i)
        EXPECT_FALSE(waiting.push("eve", "eve" + std::to_string(i)));
    EXPECT_FALSE(waiting.push("ann", "ann0"));
    std::vector<std::string> order;
    while (!waiting.empty())
        order.push_back(waiting.pop());
    EXPECT_THAT(order, ElementsAre("eve0", "ann0", "eve1", "eve2"));
}

TEST(AskerTurnsTest, MoreThanItsShare_IsGivenBack_AndAFullOneMakesRoomForOthers) {
    using Waiting = bus::AskerTurns<std::string>;
    Waiting waiting;
    std::size_t left = 0;
    for (std::size_t i = 0; i < 2 * Waiting::kMax; ++i)
        left += waiting.push("eve" + std::to_string(i % 40), "eve").has_value();
    EXPECT_EQ(left, Waiting::kMax) << "kMax have a place";
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(waiting.push("ann", "ann"), "eve") << "the one with most loses one";
    std::size_t turns = 0;
    while (waiting.pop() != "ann")
        ++turns;
    EXPECT_LE(turns, 40U);
    for (std::size_t i = 0; i < Waiting::kMaxOfAsker; ++i)
        waiting.push("bob", "bob");
    EXPECT_EQ(waiting.push("bob", "one more"), "one more");
}

/// Boards whose whole descriptions take more than one packet, and a history of long rows.
class LongAnswers : public testing::Test {
  protected:
    LongAnswers() {
        for (int i = 0; i < 600; ++i) {
            const auto board = description("uno" + std::to_string(i));
            catalogue.apply(board.view(), at(0s));
        }
        dependencies.history = [this](const bus::Query& query, const Queries::Done& done) {
            reads.push_back(query.limit);
            if (reads_later) return later.push_back(done);
            bus::Answer page;
            page.find = bus::Find::kHistory;
            page.history.resize(query.limit);
            for (auto& row : page.history)
                row.request = std::string(1000, 'x');
            done(std::move(page));
        };
    }
    mqtt::Message question(const std::string& text, const std::string& answers) {
        return mqtt::Message{.payload = text, .response_topic = answers};
    }

    Catalogue catalogue;
    Queries::Dependencies dependencies{catalogue, [] { return instant(at(0s)); }, [] { return 0; }, {}, {}};
    std::vector<std::size_t> reads;
    bool reads_later = false;
    std::vector<Queries::Done> later;
    std::vector<mqtt::Message> said;
};

TEST_F(LongAnswers, NoneIsLongerThanOurBrokersTake_WhateverTheBrokerSays) {
    Queries queries("r1", dependencies);
    for (const std::size_t told : {std::size_t{0}, std::size_t{1} << 20, std::size_t{100'000}}) {
        QueryEndpoint endpoint(
            queries, [this](mqtt::Message answer) { said.push_back(std::move(answer)); },
            [](const std::string&) { return true; });
        endpoint.set_max_bytes(told);
        const auto limit = std::min(told == 0 ? bus::kBrokerPacketBytes : told, bus::kBrokerPacketBytes);
        for (const auto* text : {R"({"find":"boards","limit":1000})", R"({"find":"boards","full":true})",
                                 R"({"find":"history","limit":1000})"}) {
            said.clear();
            endpoint.request(question(text, "answers"), false, at(0s));
            ASSERT_EQ(said.size(), 1U);
            EXPECT_LE(said[0].payload.size(), limit) << text;
            EXPECT_GT(said[0].payload.size(), limit / 5) << text;
        }
    }
}

TEST_F(LongAnswers, FloodOfAnAsker_IsRefused_AndOthersAreAnsweredInTheirTurn) {
    Queries queries("r1", dependencies);
    QueryEndpoint endpoint(
        queries, [this](mqtt::Message answer) { said.push_back(std::move(answer)); },
        [](const std::string&) { return true; });
    // One user with many clients; the other user has one.
    for (int i = 0; i < 500; ++i)
        endpoint.request(question(R"({"find":"boards"})", "asip/reply/eve/registry/" + std::to_string(i)),
                         false, at(0s));
    const auto refused = std::count_if(said.begin(), said.end(), [](const auto& answer) {
        return answer.payload.find("queue-full") != std::string::npos;
    });
    EXPECT_EQ(refused, 64) << "more is not told before the next tick";
    endpoint.request(question(R"({"find":"boards"})", "asip/reply/ann/registry/1"), false, at(0s));
    said.clear();
    endpoint.turn();
    endpoint.turn();
    ASSERT_EQ(said.size(), 2U);
    EXPECT_EQ(said[1].topic, "asip/reply/ann/registry/1");
    while (endpoint.waits())
        endpoint.turn();
    EXPECT_EQ(said.size(), 33U);
}

TEST_F(LongAnswers, OneQuestionOfTheHistoryIsReadAtATime_AndDelaysNoOthers) {
    reads_later = true;
    Queries queries("r1", dependencies);
    QueryEndpoint endpoint(
        queries, [this](mqtt::Message answer) { said.push_back(std::move(answer)); },
        [](const std::string&) { return true; });
    for (int i = 0; i < 5; ++i)
        endpoint.request(question(R"({"find":"history"})", "asip/reply/eve/registry/1"), false, at(0s));
    endpoint.request(question(R"({"find":"boards"})", "asip/reply/ann/registry/1"), false, at(0s));
    EXPECT_EQ(said.size(), 1U) << "the boards";
    endpoint.tick(at(1s));
    EXPECT_EQ(reads.size(), 1U);
    later[0]({});
    endpoint.tick(at(1s));
    EXPECT_EQ(said.size(), 2U);
    EXPECT_EQ(reads.size(), 2U);
}

/// The answer of a registry that knows the standard models.
bus::Answer ask_models(const std::string& query, std::size_t max_bytes = 0) {
    Catalogue catalogue;
    Queries::Dependencies dependencies{catalogue, [] { return instant(at(0s)); }, [] { return 0; }, {}, {}};
    dependencies.models = model::ModelSet::standard();
    Queries queries("r1", dependencies);
    bus::Answer result;
    const auto request = bus::read_registry_request(nlohmann::json::parse(query));
    if (!request) return queries.refuse("invalid", request.error());
    queries.answer(*request, max_bytes, [&result](bus::Answer answer) { result = std::move(answer); });
    return *bus::parse_answer(bus::encode(result));
}

TEST(ModelsQuestion, GivesTheWholeModelsOfTheKindsThatAreNamed) {
    const auto answer = ask_models(R"({"find":"models","kind":["servo","tone","nothing"]})");
    EXPECT_EQ(answer.find, bus::Find::kModels);
    ASSERT_EQ(answer.models.size(), 2U);
    const auto servo = model::parse_service_model(answer.models.front());
    ASSERT_TRUE(servo) << servo.error();
    EXPECT_EQ(servo->ref(), "servo@1");
    EXPECT_TRUE(model::ModelSet::is_standard(*servo));
    EXPECT_THAT(ask_models(R"({"find":"models","kind":"nothing"})").models, IsEmpty());
}

TEST(ModelsQuestion, PagesHoldEachModelOnce_AndFitIntoAPacket) {
    for (const auto& [limit, max_bytes] :
         {std::pair{"3", std::size_t{0}}, std::pair{"100", std::size_t{8192}}}) {
        std::vector<std::string> names;
        std::string cursor;
        do {
            const auto answer = ask_models(
                R"({"find":"models","limit":)" + std::string(limit) + R"(,"cursor":")" + cursor + "\"}",
                max_bytes);
            EXPECT_LE(bus::encode(answer).size(), max_bytes == 0 ? 1 << 20 : max_bytes);
            for (const auto& text : answer.models)
                names.push_back(nlohmann::json::parse(text)["name"].get<std::string>());
            cursor = answer.cursor;
        } while (!cursor.empty() && names.size() < 100);
        EXPECT_EQ(names, model::ModelSet::standard().names());
    }
}

TEST(ModelsQuestion, FiltersOfBoards_AreRefused) {
    EXPECT_EQ(ask_models(R"({"find":"models","board":"uno*"})").refused, "invalid");
    EXPECT_THAT(ask_models(R"({"find":"models","knd":"servo"})").error,
                testing::HasSubstr("did you mean \"kind\"?"));
}

}  // namespace
}  // namespace asip::registry
