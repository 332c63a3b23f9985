// SPDX-License-Identifier: Apache-2.0
#include "cli/events/stats_model.hpp"

#include <gmock/gmock.h>

namespace asip::cli {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kDocument = R"({
  "board":"uno1","uptime":630.2,"line":{"lines_in":5200,"lines_out":1800,"malformed":3,"resets":1},
  "commands":{"ok":512,"unproven":20,"error":3,"timeout/doubt":1,"refused/queue-full":7},
  "round_trip":{"p50":0.0021,"p99":0.068},"queue":{"commands":4},"holds":{"active":2},
  "bus":{"dropped_values":10,"superseded_values":1,"dropped_answers":0}})";

TEST(StatsModel, Document_IsOneRow) {
    StatsModel model;
    model.take("uno1", kDocument, Time{});
    const auto table = model.table(Time{} + 3s).render(0, false);
    EXPECT_THAT(table,
                ::testing::MatchesRegex(
                    "BOARD +AGE +UP +IN +OUT +COMMANDS +FAILED +P50 +P99 +QUEUE +HELD +BAD +RESETS +"
                    "DROPPED\nuno1 +3.0 s +10 min +5200 +1800 +543 +11 +2.10 ms +68 ms +4 +2 +3 +1 +10\n"));
}

TEST(StatsModel, NothingMeasuredInTheInterval_IsADash) {
    StatsModel model;
    model.take("uno1", R"({"round_trip":{"p50":null,"p99":null}})", Time{});
    EXPECT_THAT(model.table(Time{}).render(0, false), HasSubstr(" - "));
}

TEST(StatsModel, NewerDocument_TakesThePlaceOfTheOlder) {
    StatsModel model;
    model.take("uno1", R"({"line":{"lines_in":1}})", Time{});
    model.take("uno1", R"({"line":{"lines_in":2}})", Time{} + 15s);
    const auto records = model.records(Time{} + 20s);
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0]["line"]["lines_in"], 2);
    EXPECT_EQ(records[0]["age"], 5.0);
    EXPECT_EQ(records[0]["board"], "uno1");
}

TEST(StatsModel, WhateverSomebodyPublishes_IsShownAsFarAsItCanBe) {
    StatsModel model;
    for (const char* payload : {"", "{", "7", "[]", "null"})
        model.take("bad", payload, Time{});
    EXPECT_TRUE(model.empty());
    model.take("odd",
               R"({"line":7,"commands":[],"round_trip":"fast","uptime":"long","bus":{"dropped_values":-5}})",
               Time{});
    model.take("more", R"({"commands":{"ok":"many","error":{}}})", Time{});
    const auto table = model.table(Time{}).render(0, false);
    EXPECT_THAT(table, HasSubstr("odd"));
    EXPECT_THAT(table, HasSubstr("more"));
    EXPECT_THAT(table, Not(HasSubstr("bad")));
}

}  // namespace
}  // namespace asip::cli
