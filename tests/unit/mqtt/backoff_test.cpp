// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/backoff.hpp"

#include <gtest/gtest.h>

namespace asip::mqtt {
namespace {

using namespace std::chrono_literals;

TEST(Backoff, LowestDraw_DoublesFromHalfTheFirstToHalfTheMost) {
    Backoff backoff(100ms, 1s);
    const Random lowest = [] { return std::uint64_t{0}; };
    for (const auto expected : {50ms, 100ms, 200ms, 400ms, 500ms, 500ms})
        EXPECT_EQ(backoff.next(lowest), expected);
    backoff.reset();
    EXPECT_EQ(backoff.next(lowest), 50ms);
}

TEST(Backoff, HighestDraw_StaysWithinTheMost) {
    Backoff backoff(100ms, 1s);
    const Random highest = [] { return ~std::uint64_t{0}; };
    for (int i = 0; i < 40; ++i)
        EXPECT_LE(backoff.next(highest), 1s);
}

}  // namespace
}  // namespace asip::mqtt
