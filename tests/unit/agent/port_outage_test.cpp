// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "agent/port/port_outage.hpp"

namespace asip::agent {
namespace {

using namespace std::chrono_literals;

TEST(PortOutage, FirstAttempt_IsTheOneBeforeAnyOtherAndBeforeThePortWasOpen) {
    PortOutage failing;
    EXPECT_TRUE(failing.first_attempt());
    EXPECT_FALSE(failing.first_attempt());
    PortOutage opened;
    opened.opened();
    EXPECT_FALSE(opened.first_attempt());
}

TEST(PortOutage, FourAttemptsASecond_AreReportedOnceThenOnceAMinute) {
    PortOutage outage;
    int reported = 0;
    for (Time now{}; now < Time{} + 150s; now += 250ms)
        reported += outage.failed(link::StreamError::Kind::kNotThere, now);
    EXPECT_EQ(reported, 3);
}

TEST(PortOutage, KindsOfFailureInTurns_AreReportedOnceEach) {
    PortOutage outage;
    int reported = 0;
    for (Time now{}; now < Time{} + 30s; now += 500ms) {
        reported += outage.failed(link::StreamError::Kind::kNotThere, now);
        reported += outage.failed(link::StreamError::Kind::kClosed, now + 250ms);
    }
    EXPECT_EQ(reported, 2);
}

TEST(PortOutage, BoardHeard_IsReportedOnceAndTheNextOutageAtOnce) {
    PortOutage outage;
    EXPECT_FALSE(outage.heard()) << "there was none";
    EXPECT_TRUE(outage.failed(link::StreamError::Kind::kNotThere, Time{}));
    EXPECT_TRUE(outage.heard());
    EXPECT_FALSE(outage.heard());
    EXPECT_TRUE(outage.failed(link::StreamError::Kind::kNotThere, Time{} + 1s));
}

}  // namespace
}  // namespace asip::agent
