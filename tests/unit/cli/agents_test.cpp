// SPDX-License-Identifier: Apache-2.0
#include "cli/doctor/agents.hpp"

#include <gmock/gmock.h>

namespace asip::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kDocument = R"({
  "board":"uno1","uptime":630.2,"line":{"lines_in":5200,"lines_out":1800,"malformed":3,"resets":1},
  "commands":{"ok":512,"unproven":20,"error":3,"timeout/doubt":1,"refused/queue-full":7},
  "round_trip":{"p50":0.0021,"p99":0.068},"queue":{"commands":4},"holds":{"active":2},
  "bus":{"dropped_values":10,"superseded_values":1,"dropped_answers":0}})";

TEST(AgentCounts, Document_IsOneRow) {
    AgentCounts counts;
    take_counts(counts, "uno1", kDocument);
    EXPECT_THAT(counts_table(counts).render(0, false),
                ::testing::MatchesRegex(
                    "BOARD +UP +IN +OUT +COMMANDS +FAILED +P50 +P99 +QUEUE +HELD +BAD +RESETS +"
                    "DROPPED\nuno1 +10 min +5200 +1800 +543 +11 +2.10 ms +68 ms +4 +2 +3 +1 +10\n"));
}

TEST(AgentCounts, NothingMeasuredInTheInterval_IsADash) {
    AgentCounts counts;
    take_counts(counts, "uno1", R"({"round_trip":{"p50":null,"p99":null}})");
    EXPECT_THAT(counts_table(counts).render(0, false), HasSubstr(" - "));
}

TEST(AgentCounts, NewerDocument_TakesThePlaceOfTheOlder) {
    AgentCounts counts;
    take_counts(counts, "uno1", R"({"line":{"lines_in":1}})");
    take_counts(counts, "uno1", R"({"line":{"lines_in":2}})");
    ASSERT_EQ(counts.size(), 1u);
    EXPECT_EQ(counts["uno1"]["line"]["lines_in"], 2);
}

TEST(AgentCounts, WhateverSomebodyPublishes_IsShownAsFarAsItCanBe) {
    AgentCounts counts;
    for (const char* payload : {"", "{", "7", "[]", "null"})
        take_counts(counts, "bad", payload);
    EXPECT_TRUE(counts.empty());
    take_counts(
        counts, "odd",
        R"({"line":7,"commands":[],"round_trip":"fast","uptime":"long","bus":{"dropped_values":-5}})");
    take_counts(counts, "more", R"({"commands":{"ok":"many","error":{}}})");
    const auto table = counts_table(counts).render(0, false);
    EXPECT_THAT(table, HasSubstr("odd"));
    EXPECT_THAT(table, HasSubstr("more"));
    EXPECT_THAT(table, Not(HasSubstr("bad")));
}

}  // namespace
}  // namespace asip::cli
