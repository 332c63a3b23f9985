// SPDX-License-Identifier: Apache-2.0
// The whole loop in simulated time: does the robot keep to its line, and how well.
#include <gtest/gtest.h>

#include "tests/robot/lockstep.hpp"

namespace asip::test {
namespace {

using namespace std::chrono_literals;

Driven on_track(const Drive& how) {
    return drive(how, ASIP_MIRTO, ASIP_TRACK);
}

class PublishedGains : public testing::TestWithParam<Path> {};

TEST_P(PublishedGains, TwoLaps_KeepToTheLine) {
    const auto driven = on_track({.path = GetParam()});
    EXPECT_TRUE(driven.ok(2)) << "laps: " << driven.laps.size();
    EXPECT_LT(driven.rms_mm(), 12);
    EXPECT_NEAR(driven.commands, driven.reports, 3) << "each report is answered by a command";
    EXPECT_EQ(driven.unproven, 0u);
}

INSTANTIATE_TEST_SUITE_P(Over, PublishedGains, testing::Values(serial_path(), tcp_path(), mqtt_path()),
                         [](const auto& chosen) { return chosen.param.name; });

TEST(Lockstep, FiftyHertzOverMqtt_DrivesAsWellAsOverTheSerialPort) {
    const auto serial = on_track({.period = 20ms});
    const auto mqtt = on_track({.path = mqtt_path(), .period = 20ms});
    ASSERT_TRUE(serial.ok(2) && mqtt.ok(2));
    EXPECT_NEAR(mqtt.lap_seconds() / serial.lap_seconds(), 1, 0.02);
    EXPECT_LT(mqtt.rms_mm() / serial.rms_mm(), 1.10);
}

// Here the firmware's fast line once sent all of its ring again, each few laps, and control was lost for a
// second.
TEST(Lockstep, HundredHertz_KeepsToTheMiddleOfTheLine) {
    const auto driven = on_track({.period = 10ms});
    ASSERT_TRUE(driven.ok(2));
    EXPECT_LT(driven.rms_mm(), 3);
    EXPECT_LT(driven.laps.back().max_mm, 6);
    // Edges of both wheels in one moment keep the board from reading for 40 us; with 55 us two in 3,000 were
    // damaged.
    EXPECT_LE(driven.unproven, 1u);
}

TEST(Lockstep, SameSeed_IsTheSameDriveToTheMicrometre) {
    const auto one = on_track({.path = mqtt_path(), .laps = 1});
    const auto same = on_track({.path = mqtt_path(), .laps = 1});
    EXPECT_EQ(one.took, same.took);
    EXPECT_EQ(one.rms_mm(), same.rms_mm());
}

TEST(Lockstep, LatencyBeyondAllMeasure_LeavesTheLine) {
    const auto driven = on_track({.path = {"far", 400ms, 0ms, 0}});
    EXPECT_FALSE(driven.stayed);
}

TEST(Lockstep, EveryTenthMessageLost_StillKeepsToTheLine) {
    const auto driven = on_track({.path = {"lossy", 1ms, 2ms, 0.1}});
    EXPECT_TRUE(driven.ok(2));
}

}  // namespace
}  // namespace asip::test
