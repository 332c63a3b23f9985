// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/delivery.hpp"

#include <gtest/gtest.h>

namespace asip::mqtt {
namespace {

using namespace std::chrono_literals;

constexpr Time kStart{100s};

/// On a connection on which one message came.
Delivery seen() {
    Delivery delivery(5s);
    delivery.restart(kStart - 6s);
    delivery.sent(kStart - 6s);
    delivery.came(kStart - 5s);
    return delivery;
}

TEST(Delivery, OneIsUnderWayAtATime) {
    Delivery delivery(5s);
    delivery.restart(kStart);
    EXPECT_FALSE(delivery.due(kStart)) << "others are served first";
    EXPECT_TRUE(delivery.due(kStart + 1s));
    delivery.sent(kStart);
    EXPECT_FALSE(delivery.due(kStart + 1h));
    delivery.came(kStart + 1s);
    EXPECT_FALSE(delivery.due(kStart + 5s));
    EXPECT_TRUE(delivery.due(kStart + 6s));
    EXPECT_FALSE(delivery.lost(kStart + 1h));
}

TEST(Delivery, CameAMomentAgo_Works) {
    auto delivery = seen();
    EXPECT_TRUE(delivery.works(kStart - 5s));
    EXPECT_TRUE(delivery.works(kStart + 3s));
    EXPECT_FALSE(delivery.works(kStart + 4s));
    delivery.restart(kStart - 5s);
    EXPECT_FALSE(delivery.works(kStart - 5s)) << "that was another connection";
}

TEST(Delivery, OnesThatAreSeldom_SayHowItIsForAShortTime) {
    Delivery delivery(1min);
    delivery.restart(kStart);
    delivery.sent(kStart);
    delivery.came(kStart);
    EXPECT_TRUE(delivery.works(kStart + 8s));
    EXPECT_FALSE(delivery.works(kStart + 9s));
    EXPECT_FALSE(delivery.due(kStart + 4s, true));
    EXPECT_TRUE(delivery.due(kStart + 5s, true)) << "in doubt there are more";
    EXPECT_FALSE(delivery.due(kStart + 59s));
    EXPECT_TRUE(delivery.due(kStart + 60s));
}

TEST(Delivery, WhatWasSentBeforeOneThatCame_WasTaken) {
    auto delivery = seen();
    EXPECT_TRUE(delivery.took(kStart - 7s));
    EXPECT_FALSE(delivery.took(kStart - 6s));
    delivery.sent(kStart);
    EXPECT_FALSE(delivery.took(kStart - 1s));
    delivery.behind(kStart + 2s);
    delivery.came(kStart + 3s);
    EXPECT_TRUE(delivery.took(kStart - 1s));
    EXPECT_FALSE(delivery.took(kStart + 1s)) << "it left behind this one";
    delivery.restart(kStart + 4s);
    EXPECT_FALSE(delivery.took(kStart - 1s)) << "that was another connection";
}

TEST(Delivery, NoneEverCame_NoBrokerIsLeft) {
    Delivery delivery(5s);
    delivery.restart(kStart);
    delivery.sent(kStart);
    EXPECT_FALSE(delivery.lost(kStart + 1h));
}

TEST(Delivery, OneDoesNotCome_TheBrokerIsLeft) {
    auto delivery = seen();
    delivery.sent(kStart);
    EXPECT_FALSE(delivery.lost(kStart + 2s));
    EXPECT_TRUE(delivery.lost(kStart + 3s));
}

TEST(Delivery, OthersCome_ItMayBeBehindThem) {
    auto delivery = seen();
    delivery.sent(kStart);
    for (auto at = kStart; at < kStart + 29s; at += 1s) {
        delivery.heard(at);
        EXPECT_FALSE(delivery.lost(at));
    }
    EXPECT_TRUE(delivery.lost(kStart + 30s)) << "not for ever";
}

TEST(Delivery, ClientHasNotReadYet_NothingIsLost) {
    auto delivery = seen();
    delivery.sent(kStart);
    delivery.behind(kStart + 40s);
    EXPECT_FALSE(delivery.lost(kStart + 42s));
    EXPECT_TRUE(delivery.lost(kStart + 43s));
}

TEST(Delivery, BrokerAfterBrokerDeliversNothing_IsTriedForLongerAndLonger) {
    auto delivery = seen();
    for (const auto patience : {3s, 6s, 12s, 24s, 48s, 48s}) {
        delivery.restart(kStart);
        delivery.sent(kStart);
        EXPECT_FALSE(delivery.lost(kStart + patience - 1ms));
        EXPECT_TRUE(delivery.lost(kStart + patience));
        delivery.leave();
    }
    delivery.came(kStart);
    delivery.sent(kStart);
    EXPECT_TRUE(delivery.lost(kStart + 3s));
}

TEST(Delivery, ClosedBeforeOneEverCame_IsNotTriedAgain) {
    Delivery delivery(5s);
    delivery.restart(kStart);
    delivery.sent(kStart);
    delivery.closed();
    delivery.restart(kStart);
    EXPECT_FALSE(delivery.due(kStart + 1h));
    auto other = seen();
    other.sent(kStart);
    other.closed();
    other.restart(kStart);
    EXPECT_TRUE(other.due(kStart + 1s)) << "it was for something else";
}

TEST(Delivery, Off_IsNeverDue) {
    Delivery delivery(0s);
    delivery.restart(kStart);
    EXPECT_FALSE(delivery.due(kStart + 1h));
}

}  // namespace
}  // namespace asip::mqtt
