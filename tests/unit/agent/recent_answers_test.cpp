// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "agent/command/recent_answers.hpp"

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

using Seen = RecentAnswers::Seen;

TEST(RecentAnswers, RefusedAndSeenAgain_IsKeptItsWholeMinute) {
    RecentAnswers recent;
    recent.see(key_of(1), "p", Time{});
    recent.answer(key_of(1), bus::Reply::refused("queue-full", "later"));
    EXPECT_EQ(recent.see(key_of(1), "p", Time{} + 30s), Seen::kNew);
    EXPECT_EQ(recent.see(key_of(1), "p", Time{} + 80s), Seen::kPending);
    EXPECT_EQ(recent.see(key_of(1), "p", Time{} + 91s), Seen::kNew);
}

TEST(RecentAnswers, RefusedAndSentNoLater_IsACopyAndRefusedAgain) {
    constexpr Time kSent{1000s};
    RecentAnswers recent;
    const auto see = [&](Time sent, const char* payload = "p") {
        return recent.see(key_of(1), payload, Time{}, sent);
    };
    const auto refuse = [&] { recent.answer(key_of(1), bus::Reply::refused("deadline", "too late")); };
    EXPECT_EQ(see(kSent), Seen::kNew);
    refuse();
    EXPECT_EQ(see(kSent), Seen::kAnswered);
    EXPECT_EQ(recent.find(key_of(1))->status, bus::Reply::Status::kRefused);
    EXPECT_EQ(recent.find(key_of(1))->reason, "deadline");
    EXPECT_EQ(see(kSent + 4s, "q"), Seen::kNew) << "tried again";
    refuse();
    EXPECT_EQ(see(kSent), Seen::kAnswered) << "a copy of the first try";
    EXPECT_EQ(see(kSent + 5s), Seen::kNew);
    recent.answer(key_of(1), bus::Reply::ok("fence"));
    EXPECT_EQ(see(kSent + 6s), Seen::kAnswered);
    EXPECT_EQ(recent.find(key_of(1))->status, bus::Reply::Status::kOk);
    EXPECT_EQ(see(kSent + 6s, "q"), Seen::kOtherPayload);
}

TEST(RecentAnswers, FloodOfRefusals_TakesNoMoreThanOneOfAnswers) {
    RecentAnswers recent;
    for (int i = 0; i < 16'000; ++i) {
        recent.see(key_of(i), "p", Time{}, Time{});
        recent.answer(key_of(i), bus::Reply::refused("queue-full", std::string(1000, 'x')));
    }
    EXPECT_EQ(recent.dropped(), 0u);
    EXPECT_LE(recent.bytes(), RecentAnswers::kMaxBytes);
}

}  // namespace
}  // namespace asip::agent
