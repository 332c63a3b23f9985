// SPDX-License-Identifier: Apache-2.0
// What an answer means: tests/vectors/answers.json, which the tests of the Python package and of the Node-RED
// nodes read, too.
#include "asip/bus/request/reply.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/patterns.hpp"

namespace asip::bus {
namespace {

using nlohmann::json;

const json& answers() {
    static const json all = json::parse(std::ifstream(ASIP_SOURCE_DIR "/tests/vectors/answers.json"));
    return all;
}

std::string executed(const Reply& reply) {
    return may_have_been_executed(reply)                                    ? "maybe"
           : reply.succeeded() || (reply.status == Reply::Status::kTimeout) ? "yes"
                                                                            : "no";
}

TEST(AnswerWords, EachAnswer_HasTheSentenceOfAllLanguages) {
    EXPECT_EQ(answers().at("maybe").get<std::string>(), kMayHaveBeenExecuted);
    for (const auto& vector : answers().at("answers")) {
        const auto reply = parse_reply(vector.at("answer").dump());
        ASSERT_TRUE(reply) << vector;
        EXPECT_EQ(sentence_of(*reply), vector.at("text").get<std::string>()) << vector;
        EXPECT_EQ(executed(*reply), vector.at("executed").get<std::string>()) << vector;
    }
}

TEST(AnswerWords, WhatIsNoAnswer_IsUnreadable) {
    for (const auto& vector : answers().at("unreadable")) {
        EXPECT_FALSE(parse_reply(vector.at("answer").dump())) << vector;
        EXPECT_EQ(sentence_of(read_answer(vector.at("answer").dump())), vector.at("text").get<std::string>());
    }
}

TEST(AnswerWords, EachStatusAndReason_HasTheWordsOfAllLanguages) {
    json words = json::object();
    for (const auto& each : answer_words())
        words[std::string(to_string(each.status))][std::string(each.reason)] = each.words;
    EXPECT_EQ(words, answers().at("words"));
    for (const auto status : {Reply::Status::kError, Reply::Status::kTimeout, Reply::Status::kRefused}) {
        Reply reply;
        reply.status = status;
        EXPECT_FALSE(sentence_of(reply).empty()) << to_string(status);
    }
}

// A reason that is added to a header and to no table would be shown as a bare word.
TEST(AnswerWords, EachReasonThatIsDeclared_IsInTheTable) {
    std::size_t found = 0;
    for (const auto& file : std::filesystem::directory_iterator(ASIP_SOURCE_DIR "/asip/bus/request")) {
        if (file.path().extension() != ".hpp") continue;
        std::ifstream in(file.path());
        const std::string text{std::istreambuf_iterator<char>(in), {}};
        for (const auto& each : test::all_matches(text, "k(Refused|Timeout)\\w+ = \"([^\"]+)\"")) {
            const std::string status = each[1] == "Refused" ? "refused" : "timeout";
            EXPECT_TRUE(answers().at("words").at(status).contains(each[2])) << each[0];
            ++found;
        }
    }
    EXPECT_EQ(found, answer_words().size() - 1);  // no reason at all is declared nowhere
}

}  // namespace
}  // namespace asip::bus
