// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/unreceived.hpp"

#include <gtest/gtest.h>

namespace asip::mqtt {
namespace {

using namespace std::chrono_literals;

constexpr Time kBegin{100s};

TEST(Unreceived, NothingAcknowledgedForTheLimit_IsOver) {
    Unreceived unreceived(5s);
    EXPECT_FALSE(unreceived.look(kBegin, true, 1h)) << "it may have been sent just now";
    EXPECT_FALSE(unreceived.look(kBegin + 4s, true, 1h));
    EXPECT_TRUE(unreceived.look(kBegin + 5s, true, 1h));
}

TEST(Unreceived, SomethingAcknowledgedMeanwhile_CountsFromThen) {
    Unreceived unreceived(5s);
    EXPECT_FALSE(unreceived.look(kBegin, true, 0s));
    EXPECT_FALSE(unreceived.look(kBegin + 4s, true, 1s));
    EXPECT_FALSE(unreceived.look(kBegin + 7s, true, 4s));
    EXPECT_TRUE(unreceived.look(kBegin + 8s, true, 5s));
}

TEST(Unreceived, AllAcknowledgedMeanwhile_BeginsAnew) {
    Unreceived unreceived(5s);
    EXPECT_FALSE(unreceived.look(kBegin, true, 1h));
    EXPECT_FALSE(unreceived.look(kBegin + 4s, false, 1h));
    EXPECT_FALSE(unreceived.look(kBegin + 6s, true, 1h));
    EXPECT_FALSE(unreceived.look(kBegin + 10s, true, 1h));
    EXPECT_TRUE(unreceived.look(kBegin + 11s, true, 1h));
}

TEST(Unreceived, NoLimit_IsNeverOver) {
    Unreceived unreceived(0s);
    EXPECT_FALSE(unreceived.look(kBegin, true, 1h));
    EXPECT_FALSE(unreceived.look(kBegin + 1h, true, 1h));
}

}  // namespace
}  // namespace asip::mqtt
