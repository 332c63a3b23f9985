// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "agent/port/outage.hpp"

namespace asip::agent {
namespace {

using namespace std::chrono_literals;

TEST(Outage, FirstAttempt_IsTheOneBeforeAnyOtherAndBeforeThePortWasOpen) {
    Outage failing;
    EXPECT_TRUE(failing.first_attempt());
    EXPECT_FALSE(failing.first_attempt());
    Outage opened;
    opened.opened();
    EXPECT_FALSE(opened.first_attempt());
}

TEST(Outage, FourAttemptsASecond_AreReportedOnceThenOnceAMinute) {
    Outage outage;
    int reported = 0;
    for (Time now{}; now < Time{} + 150s; now += 250ms)
        reported += outage.failed(link::StreamError::Kind::kNotThere, now);
    EXPECT_EQ(reported, 3);
}

TEST(Outage, KindsOfFailureInTurns_AreReportedOnceEach) {
    Outage outage;
    int reported = 0;
    for (Time now{}; now < Time{} + 30s; now += 500ms) {
        reported += outage.failed(link::StreamError::Kind::kNotThere, now);
        reported += outage.failed(link::StreamError::Kind::kClosed, now + 250ms);
    }
    EXPECT_EQ(reported, 2);
}

TEST(Outage, BoardHeard_IsReportedOnceAndTheNextOutageAtOnce) {
    Outage outage;
    EXPECT_FALSE(outage.heard()) << "there was none";
    EXPECT_TRUE(outage.failed(link::StreamError::Kind::kNotThere, Time{}));
    EXPECT_TRUE(outage.heard());
    EXPECT_FALSE(outage.heard());
    EXPECT_TRUE(outage.failed(link::StreamError::Kind::kNotThere, Time{} + 1s));
}

}  // namespace
}  // namespace asip::agent
