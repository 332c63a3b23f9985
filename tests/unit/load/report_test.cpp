// SPDX-License-Identifier: Apache-2.0
#include "bench/load/report.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace asip::load {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

TEST(Report, BoardsThatWereAnnouncedAndLeft_AreGood_BoardsThatNeverWereAreNot) {
    Report report;
    EXPECT_FALSE(report.good());
    report.tally.descriptions = 3;
    EXPECT_TRUE(report.good());
    report.present = 2;
    report.announced = 1;
    EXPECT_FALSE(report.good());
    report.announced = 2;
    EXPECT_TRUE(report.good());
    report.tally.conflicts = 1;
    EXPECT_FALSE(report.good());
}

TEST(Report, WatchedBus_NeedsARegistryThatAgrees) {
    Report report;
    report.tally.descriptions = 1;
    report.watched = true;
    EXPECT_FALSE(report.good());
    auto& registry = report.registries["r1"];
    EXPECT_FALSE(report.good());
    registry.agreed = Duration{};
    EXPECT_TRUE(report.good());
}

TEST(Report, Questions_AreGoodWhenSomeAreAnsweredAndNoneWrongly) {
    Report report;
    report.tally.descriptions = 1;
    auto& queries = report.queries.emplace();
    EXPECT_FALSE(report.good());
    queries[QuestionKind::kList].answered = 1;
    EXPECT_TRUE(report.good());
    queries[QuestionKind::kBoard].unanswered = 1;
    EXPECT_TRUE(report.good()) << "how many are too many is for whoever reads it";
    queries[QuestionKind::kBoard].wrong = 1;
    EXPECT_FALSE(report.good());
}

TEST(Report, Questions_AreToldByTheirKinds) {
    Report report;
    EXPECT_FALSE(to_json(report).contains("queries"));
    auto& queries = report.queries.emplace();
    EXPECT_THAT(to_table(report), HasSubstr("no question was answered"));
    auto& board = queries[QuestionKind::kBoard];
    board.asked = 9;
    board.answered = 7;
    board.unanswered = 2;
    board.refused = 1;
    board.took.add(20ms);
    queries.left_out = 3;
    const auto document = to_json(report).at("queries");
    EXPECT_EQ(document.at("left_out"), 3);
    EXPECT_EQ(document.at("kinds").size(), kQuestionKinds);
    const auto& kind = document.at("kinds").at("board");
    EXPECT_EQ(kind.at("asked"), 9);
    EXPECT_EQ(kind.at("answered"), 7);
    EXPECT_EQ(kind.at("unanswered"), 2);
    EXPECT_EQ(kind.at("refused"), 1);
    EXPECT_EQ(kind.at("wrong"), 0);
    EXPECT_EQ(kind.at("took").at("max_ms"), 20);
    const auto table = to_table(report);
    EXPECT_THAT(table, HasSubstr("asked: board          9: 7 answered, 2 unanswered, 1 refused, 0 wrong\n"));
    EXPECT_THAT(table, HasSubstr("  answered after      p50 20 ms"));
    EXPECT_THAT(table, HasSubstr("not asked             3: too many waited"));
    EXPECT_THAT(table, Not(HasSubstr("asked: list")));
}

TEST(Report, Watchers_AreToldByRegistries) {
    Report report;
    EXPECT_FALSE(to_json(report).contains("watchers"));
    auto& watchers = report.watchers.emplace();
    watchers.watchers = 5;
    watchers.listening = 4;
    watchers.connections_lost = 1;
    auto& seen = watchers.registries["r1"];
    seen.events = 40;
    seen.different = 10;
    seen.left_out = 2;
    seen.first.add(3ms);
    seen.last.add(9ms);
    const auto document = to_json(report).at("watchers");
    EXPECT_EQ(document.at("listening"), 4);
    EXPECT_EQ(document.at("registries").at("r1").at("events"), 40);
    EXPECT_EQ(document.at("registries").at("r1").at("left_out"), 2);
    EXPECT_EQ(document.at("registries").at("r1").at("last").at("max_ms"), 9);
    const auto table = to_table(report);
    EXPECT_THAT(table, HasSubstr("watchers              4 of 5 listen at the end, 1 connections lost"));
    EXPECT_THAT(table,
                HasSubstr("  events of r1        40 in sum, 10 different, 2 numbers left out, 0 resets"));
    EXPECT_THAT(table, HasSubstr("  seen by the first   p50 3.00 ms"));
    EXPECT_THAT(table, HasSubstr("  seen by the last    p50 9.00 ms"));
    EXPECT_THAT(table, Not(HasSubstr("very late")));
}

}  // namespace
}  // namespace asip::load
