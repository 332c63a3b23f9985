// SPDX-License-Identifier: Apache-2.0
#include "agent/inbound/process_pauses.hpp"

#include <gtest/gtest.h>

namespace asip::agent {
namespace {

using namespace std::chrono_literals;

constexpr Time kBegin{1h};

TEST(ProcessPauses, TimersInTime_Runs) {
    ProcessPauses pauses;
    EXPECT_FALSE(pauses.runs(kBegin, std::nullopt));
    EXPECT_FALSE(pauses.runs(kBegin + 2s, kBegin + 2s));
    EXPECT_FALSE(pauses.runs(kBegin + 4400ms, kBegin + 4s));
}

TEST(ProcessPauses, StoppedAndContinued_WasPausedSinceItLastRan) {
    ProcessPauses pauses;
    pauses.runs(kBegin, std::nullopt, 1);
    pauses.runs(kBegin + 1ms, std::nullopt, 1);
    const Time awake = kBegin + 1s;
    EXPECT_EQ(pauses.runs(awake, awake + 2s, 2), kBegin + 1ms);
    EXPECT_FALSE(pauses.runs(awake + 1ms, awake + 2s, 2)) << "told once";
}

TEST(ProcessPauses, NoTimer_NothingIsKnown) {
    ProcessPauses pauses;
    pauses.runs(kBegin, std::nullopt);
    EXPECT_FALSE(pauses.runs(kBegin + 1h, std::nullopt));
}

TEST(ProcessPauses, TimerLate_WasPausedSinceItLastRan) {
    ProcessPauses pauses;
    pauses.runs(kBegin, std::nullopt);
    const Time awake = kBegin + 9s;
    EXPECT_EQ(pauses.runs(awake, kBegin + 2s), kBegin);
    EXPECT_FALSE(pauses.runs(awake + 1ms, kBegin + 2s)) << "the timer itself, behind what was read first";
    EXPECT_FALSE(pauses.runs(awake + 2ms, awake + 2s));
}

}  // namespace
}  // namespace asip::agent
