// SPDX-License-Identifier: Apache-2.0
#include "registry/query_endpoint.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "messages.hpp"

namespace asip::registry {
namespace {

using testing::ElementsAre;
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
        mqtt::Message question;
        question.payload = R"({"find":"history","board":"uno1"})";
        question.response_topic = "answers";
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

}  // namespace
}  // namespace asip::registry
