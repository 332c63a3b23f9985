// SPDX-License-Identifier: Apache-2.0
#include "agent/command/held_up.hpp"

#include <gtest/gtest.h>

namespace asip::agent {
namespace {

using namespace std::chrono_literals;

constexpr Time kBegin{1h};

TEST(HeldUp, TimersInTime_Runs) {
    HeldUp held_up;
    EXPECT_FALSE(held_up.runs(kBegin, std::nullopt));
    EXPECT_FALSE(held_up.runs(kBegin + 2s, kBegin + 2s));
    EXPECT_FALSE(held_up.runs(kBegin + 4400ms, kBegin + 4s));
}

TEST(HeldUp, StoppedAndContinued_IsHeldUpSinceItLastRan) {
    HeldUp held_up;
    held_up.runs(kBegin, std::nullopt, 1);
    held_up.runs(kBegin + 1ms, std::nullopt, 1);
    const Time awake = kBegin + 1s;
    EXPECT_EQ(held_up.runs(awake, awake + 2s, 2), kBegin + 1ms);
    EXPECT_FALSE(held_up.runs(awake + 1ms, awake + 2s, 2)) << "told once";
}

TEST(HeldUp, NoTimer_NothingIsKnown) {
    HeldUp held_up;
    held_up.runs(kBegin, std::nullopt);
    EXPECT_FALSE(held_up.runs(kBegin + 1h, std::nullopt));
}

TEST(HeldUp, TimerLate_IsHeldUpSinceItLastRan) {
    HeldUp held_up;
    held_up.runs(kBegin, std::nullopt);
    const Time awake = kBegin + 9s;
    EXPECT_EQ(held_up.runs(awake, kBegin + 2s), kBegin);
    EXPECT_FALSE(held_up.runs(awake + 1ms, kBegin + 2s)) << "the timer itself, behind what was read first";
    EXPECT_FALSE(held_up.runs(awake + 2ms, awake + 2s));
}

}  // namespace
}  // namespace asip::agent
