// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/quirks/refuses_qos_1.hpp"

#include <gtest/gtest.h>

namespace asip::mqtt {
namespace {

TEST(QosLimit, BrokerAllowsLess_IsThatUntilAnotherAllowsMore) {
    QosLimit qos;
    EXPECT_FALSE(qos.broker_allows(2));
    EXPECT_TRUE(qos.broker_allows(0));
    EXPECT_EQ(qos.of(1), 0);
    EXPECT_FALSE(qos.broker_allows(0)) << "told once";
    EXPECT_FALSE(qos.broker_allows(2));
    EXPECT_EQ(qos.of(1), 1);
}

TEST(QosLimit, SubscriptionWasRefused_IsAskedForWithQos0) {
    QosLimit qos;
    EXPECT_EQ(qos.of_subscription(1, false), 1);
    EXPECT_EQ(qos.of_subscription(1, true), 0);
}

}  // namespace
}  // namespace asip::mqtt
