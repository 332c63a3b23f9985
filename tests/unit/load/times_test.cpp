// SPDX-License-Identifier: Apache-2.0
#include "bench/load/times.hpp"

#include <gtest/gtest.h>

namespace asip::load {
namespace {

using namespace std::chrono_literals;

TEST(Times, Nothing_IsZero) {
    EXPECT_EQ(Times().seconds(.5), 0);
    EXPECT_EQ(Times().longest_seconds(), 0);
}

TEST(Times, Shares_AreWithinTwoPercent) {
    Times times;
    for (int i = 1; i <= 1000; ++i)
        times.add(i * 1ms);
    EXPECT_NEAR(times.seconds(.5), .5, .5 * .023);
    EXPECT_NEAR(times.seconds(.99), .99, .99 * .023);
    EXPECT_EQ(times.seconds(1), 1);
    EXPECT_EQ(times.longest_seconds(), 1);
    EXPECT_EQ(times.count(), 1000u);
}

TEST(Times, BeyondItsClasses_AreCountedInTheOuterOnes) {
    Times times;
    times.add(-5s);
    times.add(0s);
    times.add(48h);
    EXPECT_EQ(times.count(), 3u);
    EXPECT_LT(times.seconds(.5), 1e-5);
    EXPECT_EQ(times.longest_seconds(), 48 * 3600);
}

}  // namespace
}  // namespace asip::load
