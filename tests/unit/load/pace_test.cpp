// SPDX-License-Identifier: Apache-2.0
#include "bench/load/pace.hpp"

#include <gtest/gtest.h>

namespace asip::load {
namespace {

using namespace std::chrono_literals;

/// How many are due, one after the other.
int taken(Pace& pace) {
    int count = 0;
    for (; pace.due(); pace.done())
        ++count;
    return count;
}

TEST(Pace, Rate_IsKeptHoweverOftenItIsAsked) {
    Time now{};
    Pace pace(100);
    pace.begin(now);
    int count = 0;
    for (int i = 0; i < 1000; ++i) {
        pace.pass(now += 3ms);
        count += taken(pace);
    }
    EXPECT_NEAR(count, 300, 1);
}

TEST(Pace, LessThanOneASecond_BecomesDueAllTheSame) {
    Time now{};
    Pace pace(0.5);
    pace.begin(now);
    int count = 0;
    for (int i = 0; i < 1010; ++i) {
        pace.pass(now += 10ms);
        count += taken(pace);
    }
    EXPECT_EQ(count, 5);
}

TEST(Pace, StoodStill_MakesUpForNoMoreThanASecond) {
    Pace pace(20);
    pace.begin(Time{});
    pace.pass(Time{} + 1h);
    EXPECT_EQ(taken(pace), 20);
}

}  // namespace
}  // namespace asip::load
