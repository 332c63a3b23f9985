// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/usable_qos.hpp"

#include <gtest/gtest.h>

namespace asip::mqtt {
namespace {

using namespace std::chrono_literals;

TEST(UsableQos, SlowFailureOnMqtt311_IsZeroFromThenOn) {
    UsableQos qos(1);
    EXPECT_EQ(qos.of(1), 1);
    EXPECT_TRUE(qos.failed(4s, false));
    EXPECT_EQ(qos.of(1), 0);
    EXPECT_EQ(qos.of(0), 0);
    EXPECT_FALSE(qos.failed(4s, false)) << "told once";
}

TEST(UsableQos, QuickFailureOrMqtt5_IsSomethingElse) {
    UsableQos qos(1);
    EXPECT_FALSE(qos.failed(100ms, false)) << "a broker that dies, or access rules";
    EXPECT_FALSE(qos.failed(10s, true)) << "not NATS";
    EXPECT_EQ(qos.of(1), 1);
}

TEST(UsableQos, BrokerAllowsLess_IsThatUntilAnotherAllowsMore) {
    UsableQos qos(1);
    EXPECT_FALSE(qos.broker_allows(2));
    EXPECT_TRUE(qos.broker_allows(0));
    EXPECT_EQ(qos.of(1), 0);
    EXPECT_FALSE(qos.broker_allows(0)) << "told once";
    EXPECT_FALSE(qos.broker_allows(2));
    EXPECT_EQ(qos.of(1), 1);
}

TEST(UsableQos, ZeroFromTheStart_IsZero) {
    UsableQos qos(0);
    EXPECT_EQ(qos.of(1), 0);
    EXPECT_FALSE(qos.failed(4s, false));
}

}  // namespace
}  // namespace asip::mqtt
