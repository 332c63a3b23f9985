// SPDX-License-Identifier: Apache-2.0
#include "asip/session/name_budget.hpp"

#include <gtest/gtest.h>

#include "tests/unit/session/board_session_bench.hpp"
#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {
namespace {

using namespace std::chrono_literals;

constexpr Time kFirstName{1000s};

TEST(NameBudget, SomeAtOnce_ThenOneEachTenMinutes) {
    NameBudget budget;
    for (unsigned i = NameBudget::kAtOnce; i > 0; --i) {
        EXPECT_EQ(budget.left(kFirstName), i);
        budget.spend(kFirstName);
    }
    EXPECT_EQ(budget.left(kFirstName + 599s), 0U);
    EXPECT_EQ(budget.left(kFirstName + 600s), 1U);
    budget.spend(kFirstName + 900s);
    EXPECT_EQ(budget.left(kFirstName + 1199s), 0U);
    EXPECT_EQ(budget.left(kFirstName + 1200s), 1U) << "what was waited for before counts";
    EXPECT_EQ(budget.left(kFirstName + 1000h), NameBudget::kAtOnce);
    budget.spend(kFirstName + 1000h);
    EXPECT_EQ(budget.left(kFirstName + 1000h), NameBudget::kAtOnce - 1);
}

/// In a year: far below the 100,000 writes that a cell bears.
TEST(NameBudget, AskedForAllTheTime_DoesNotWearTheMemoryOut) {
    NameBudget budget;
    unsigned stored = 0;
    for (Time now = kFirstName; now < kFirstName + 365 * 24h; now += 1min) {
        if (budget.left(now) == 0) continue;
        budget.spend(now);
        ++stored;
    }
    EXPECT_LT(stored, 53'000U);
    EXPECT_GT(stored, 52'000U);
}

TEST(NameBudget, QuestionForTheName_CostsNothing) {
    EXPECT_TRUE(NameBudget::concerns("#,I,uno1"));
    EXPECT_FALSE(NameBudget::concerns("#,I"));
    EXPECT_FALSE(NameBudget::concerns("I,d,13,1"));
}

TEST(BoardSession, NamesTooOften_AreRefusedAndOtherRequestsWork) {
    ReadyBench bench;
    for (unsigned i = 0; i < NameBudget::kAtOnce; ++i)
        bench.request("#,I,name" + std::to_string(i));
    EXPECT_EQ(bench.refused("#,I,another"), Refusal::kTooManyNames);
    EXPECT_EQ(bench.refused("#,I,another\n"), Refusal::kTooManyNames);
    bench.request("#,I");
    const auto id = bench.request("I,d,13,1");
    EXPECT_EQ(bench.ending(id), Ending::kExecuted);
}

}  // namespace
}  // namespace asip::session
