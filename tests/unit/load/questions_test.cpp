// SPDX-License-Identifier: Apache-2.0
#include "bench/load/questions.hpp"

#include <gmock/gmock.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace asip::load {
namespace {

struct QuestionsTest : testing::Test {
    Question next() {
        return questions.next([](std::size_t board) { return "load-" + std::to_string(100'000 + board); });
    }
    Question next(QuestionKind kind) {
        for (;;)
            if (auto question = next(); question.kind == kind) return question;
    }
    static bus::Answer page(const std::string& cursor) {
        bus::Answer answer;
        answer.registry = "r2";
        answer.cursor = cursor;
        return answer;
    }

    Questions questions{{"io", "distance"}, 1000};
};

TEST_F(QuestionsTest, Mix_IsMostlyOneBoardByNameAndHasEachKind) {
    std::map<QuestionKind, int> counts;
    std::set<std::size_t> boards;
    for (int i = 0; i < 2000; ++i) {
        const auto question = next();
        ++counts[question.kind];
        if (question.board) boards.insert(*question.board);
    }
    EXPECT_EQ(counts[QuestionKind::kBoard], 1400);
    EXPECT_EQ(counts[QuestionKind::kDescription], 200);
    EXPECT_EQ(counts[QuestionKind::kServices], 200);
    EXPECT_EQ(counts[QuestionKind::kList], 100);
    EXPECT_EQ(counts[QuestionKind::kPattern], 100);
    EXPECT_GT(boards.size(), 600u) << "spread over the boards";
}

TEST_F(QuestionsTest, Each_IsOneThatRegistriesTake) {
    for (int i = 0; i < 100; ++i) {
        const auto question = next();
        const auto text = bus::encode(bus::RegistryRequest{question.query, {}, {}});
        const auto read = bus::read_registry_request(nlohmann::json::parse(text));
        ASSERT_TRUE(read) << text << read.error();
        EXPECT_EQ(std::get<bus::Query>(*read), question.query) << text;
        EXPECT_EQ(question.query.limit, 100u);
        EXPECT_EQ(question.registry, "");
    }
    EXPECT_THAT(next(QuestionKind::kPattern).query.board, testing::MatchesRegex("load-1[0-9]+\\?\\?"));
    EXPECT_THAT(next(QuestionKind::kServices).query.kind, testing::SizeIs(1));
}

TEST_F(QuestionsTest, NextPage_IsAskedOfTheRegistryThatGaveTheOneBefore) {
    const auto first = next(QuestionKind::kList);
    questions.answered(first, page("c1"));
    const auto second = next(QuestionKind::kList);
    EXPECT_EQ(second.registry, "r2");
    EXPECT_EQ(second.query.cursor, "c1");
    EXPECT_EQ(next(QuestionKind::kServices).query.cursor, "") << "another kind begins for itself";
    questions.answered(second, page(""));
    EXPECT_EQ(next(QuestionKind::kList).query.cursor, "") << "from the first page again";
    questions.answered(second, page(std::string(300, 'c')));
    EXPECT_EQ(next(QuestionKind::kList).query.cursor, "") << "longer than a registry takes";
}

TEST(QuestionAnswer, Holds_WhatItLists) {
    bus::Answer answer;
    EXPECT_FALSE(holds(answer, "load-1"));
    answer.boards.emplace_back().board = "load-1";
    EXPECT_TRUE(holds(answer, "load-1"));
    EXPECT_FALSE(holds(answer, "load-2"));
}

}  // namespace
}  // namespace asip::load
