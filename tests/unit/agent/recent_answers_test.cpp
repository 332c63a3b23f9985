// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "agent/recent_answers.hpp"

namespace asip::agent {
namespace {

using namespace std::chrono_literals;

RecentAnswers::Key key_of(int number) {
    return RecentAnswers::key("asip/uno1/servo/in", "answers", std::to_string(number));
}

TEST(RecentAnswers, SixteenThousandAnswers_AreKeptInTwoMegabytes) {
    RecentAnswers recent;
    const int count = static_cast<int>(RecentAnswers::kGuaranteed);
    for (int i = 0; i < count; ++i) {
        recent.see(key_of(i), "p", Time{});
        recent.answer(key_of(i), bus::Reply::ok("fence"));
    }
    EXPECT_EQ(recent.dropped(), 0u);
    EXPECT_EQ(recent.see(key_of(0), "p", Time{}), RecentAnswers::Seen::kAnswered);
    EXPECT_LE(recent.bytes(), RecentAnswers::kMaxBytes);
}

TEST(RecentAnswers, LongAnswers_OldestAreDroppedAndCounted) {
    RecentAnswers recent;
    for (int i = 0; i < 10'000; ++i) {
        recent.see(key_of(i), "p", Time{});
        recent.answer(key_of(i), bus::Reply::ok("answer", std::string(1000, 'x')));
        ASSERT_LE(recent.bytes(), RecentAnswers::kMaxBytes);
    }
    EXPECT_GT(recent.dropped(), 7'000u);
    EXPECT_EQ(recent.find(key_of(0)), nullptr);
    ASSERT_NE(recent.find(key_of(9'999)), nullptr);
    EXPECT_EQ(recent.find(key_of(9'999))->answer.size(), 1000u);
}

TEST(RecentAnswers, ForgottenAndSeenAgain_IsKeptItsWholeMinute) {
    RecentAnswers recent;
    recent.see(key_of(1), "p", Time{});
    recent.forget(key_of(1));
    EXPECT_EQ(recent.see(key_of(1), "p", Time{} + 30s), RecentAnswers::Seen::kNew);
    EXPECT_EQ(recent.see(key_of(1), "p", Time{} + 80s), RecentAnswers::Seen::kPending);
    EXPECT_EQ(recent.see(key_of(1), "p", Time{} + 91s), RecentAnswers::Seen::kNew);
}

}  // namespace
}  // namespace asip::agent
