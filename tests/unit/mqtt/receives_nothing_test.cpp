// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/quirks/receives_nothing.hpp"

#include <gtest/gtest.h>

namespace asip::mqtt {
namespace {

using namespace std::chrono_literals;

constexpr Time kBegin{100s};

TEST(ReceivesNothing, NothingAcknowledgedForTheLimit_IsOver) {
    ReceivesNothing host(5s);
    EXPECT_FALSE(host.look(kBegin, true, 1h)) << "it may have been sent just now";
    EXPECT_FALSE(host.look(kBegin + 4s, true, 1h));
    EXPECT_TRUE(host.look(kBegin + 5s, true, 1h));
}

TEST(ReceivesNothing, SomethingAcknowledgedMeanwhile_CountsFromThen) {
    ReceivesNothing host(5s);
    EXPECT_FALSE(host.look(kBegin, true, 0s));
    EXPECT_FALSE(host.look(kBegin + 4s, true, 1s));
    EXPECT_FALSE(host.look(kBegin + 7s, true, 4s));
    EXPECT_TRUE(host.look(kBegin + 8s, true, 5s));
}

TEST(ReceivesNothing, AllAcknowledgedMeanwhile_BeginsAnew) {
    ReceivesNothing host(5s);
    EXPECT_FALSE(host.look(kBegin, true, 1h));
    EXPECT_FALSE(host.look(kBegin + 4s, false, 1h));
    EXPECT_FALSE(host.look(kBegin + 6s, true, 1h));
    EXPECT_FALSE(host.look(kBegin + 10s, true, 1h));
    EXPECT_TRUE(host.look(kBegin + 11s, true, 1h));
}

TEST(ReceivesNothing, NoLimit_IsNeverOver) {
    ReceivesNothing host(0s);
    EXPECT_FALSE(host.look(kBegin, true, 1h));
    EXPECT_FALSE(host.look(kBegin + 1h, true, 1h));
}

}  // namespace
}  // namespace asip::mqtt
