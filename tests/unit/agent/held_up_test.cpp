// SPDX-License-Identifier: Apache-2.0
#include "agent/held_up.hpp"

#include <gtest/gtest.h>

namespace asip::agent {
namespace {

using namespace std::chrono_literals;

constexpr Time kBegin{1h};

TEST(HeldUp, TimersInTime_MessagesAreNew) {
    HeldUp held_up;
    held_up.runs(kBegin, std::nullopt);
    held_up.runs(kBegin + 2s, kBegin + 2s);
    held_up.runs(kBegin + 4400ms, kBegin + 4s);
    EXPECT_EQ(held_up.arrival(kBegin + 4401ms), kBegin + 4401ms);
}

TEST(HeldUp, StoppedAndContinued_WhatIsReadThenMayHaveComeSinceItLastRan) {
    HeldUp held_up;
    held_up.runs(kBegin, std::nullopt, 1);
    held_up.runs(kBegin + 1ms, std::nullopt, 1);
    const Time awake = kBegin + 1s;
    held_up.runs(awake, awake + 2s, 2);
    EXPECT_EQ(held_up.arrival(awake), kBegin + 1ms);
    held_up.runs(awake + 1ms, awake + 2s, 2);
    EXPECT_EQ(held_up.arrival(awake + 299ms), kBegin + 1ms);
    EXPECT_EQ(held_up.arrival(awake + 300ms), awake + 300ms);
}

TEST(HeldUp, NoTimer_NothingIsKnown) {
    HeldUp held_up;
    held_up.runs(kBegin, std::nullopt);
    held_up.runs(kBegin + 1h, std::nullopt);
    EXPECT_EQ(held_up.arrival(kBegin + 1h), kBegin + 1h);
}

TEST(HeldUp, TimerLate_WhatIsReadThenMayHaveComeSinceItLastRan) {
    HeldUp held_up;
    held_up.runs(kBegin, std::nullopt);
    const Time awake = kBegin + 9s;
    held_up.runs(awake, kBegin + 2s);
    EXPECT_EQ(held_up.arrival(awake), kBegin);
    held_up.runs(awake + 1ms, kBegin + 2s);  // the timer itself, behind what was read first
    held_up.runs(awake + 2ms, awake + 2s);
    EXPECT_EQ(held_up.arrival(awake + 299ms), kBegin);
    EXPECT_EQ(held_up.arrival(awake + 300ms), awake + 300ms);
}

}  // namespace
}  // namespace asip::agent
