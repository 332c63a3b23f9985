// SPDX-License-Identifier: Apache-2.0
#include "load/report.hpp"

#include <gtest/gtest.h>

namespace asip::load {
namespace {

TEST(Report, BoardsThatWereAnnouncedAndLeft_AreGood_BoardsThatNeverWereAreNot) {
    Report report;
    EXPECT_FALSE(report.good());
    report.tally.descriptions = 3;
    EXPECT_TRUE(report.good());
    report.present = 2;
    report.announced = 1;
    EXPECT_FALSE(report.good());
    report.announced = 2;
    EXPECT_TRUE(report.good());
    report.tally.conflicts = 1;
    EXPECT_FALSE(report.good());
}

TEST(Report, WatchedBus_NeedsARegistryThatAgrees) {
    Report report;
    report.tally.descriptions = 1;
    report.watched = true;
    EXPECT_FALSE(report.good());
    auto& registry = report.registries["r1"];
    EXPECT_FALSE(report.good());
    registry.agreed = Duration{};
    EXPECT_TRUE(report.good());
}

}  // namespace
}  // namespace asip::load
