// SPDX-License-Identifier: Apache-2.0
// The world without a board: tracks, rovers, laps, sensors, pictures.
#include <gmock/gmock.h>

#include <numbers>

#include "sim/world/picture.hpp"
#include "sim/world/world_file.hpp"

namespace asip::sim::world {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kPi = std::numbers::pi;

std::vector<Point> square() {
    return {{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}};
}

WorldSpec square_world() {
    WorldSpec spec;
    spec.line = square();
    spec.rover.lag_ms = 0;
    return spec;
}

TEST(Track, Spot_IsDarkByTheShareOfItThatIsOnTheLine) {
    const auto track = Track::create(square(), 20).value();
    EXPECT_DOUBLE_EQ(track.darkness({500, 0}, 3), 1);
    EXPECT_DOUBLE_EQ(track.darkness({500, 6.9}, 3), 1);
    EXPECT_DOUBLE_EQ(track.darkness({500, 10}, 3), 0.5);
    EXPECT_DOUBLE_EQ(track.darkness({500, -13}, 3), 0);
    EXPECT_NEAR(track.darkness({500, 0}, 20), 0.609, 0.001) << "a spot wider than the line";
}

TEST(Track, Places_AreCountedAlongTheLineWithTheirSide) {
    const auto track = Track::create(square(), 20).value();
    EXPECT_DOUBLE_EQ(track.length_mm(), 4000);
    const auto left = track.nearest({400, 15});
    EXPECT_DOUBLE_EQ(left.along, 400);
    EXPECT_DOUBLE_EQ(left.offset, 15);
    EXPECT_DOUBLE_EQ(track.nearest({400, -15}).offset, -15);
    EXPECT_DOUBLE_EQ(track.nearest({-5, 300}).along, 3700);
    const auto pose = track.at(-100);
    EXPECT_DOUBLE_EQ(pose.at.y, 100);
    EXPECT_DOUBLE_EQ(pose.heading, -kPi / 2);
}

TEST(Track, LineThatCrossesItself_IsFollowedWhereOneIs) {
    // Both ways pass through the middle
    const auto track = Track::create({{0, 0}, {100, 100}, {100, 0}, {0, 100}}, 5).value();
    const auto second = track.nearest({50, 50}, 300, 40);
    EXPECT_NEAR(second.along, 100 * std::sqrt(2) * 1.5 + 100, 0.001);
    EXPECT_NEAR(track.nearest({50, 50}, 40, 60).along, 100 * std::sqrt(2) / 2, 0.001);
}

TEST(Track, NoLine_IsRefused) {
    EXPECT_THAT(Track::create({{0, 0}, {1, 1}, {1, 1}, {0, 0}}, 20).error(), HasSubstr("three different"));
    EXPECT_THAT(Track::create(square(), 0).error(), HasSubstr("1 to 200 mm"));
}

TEST(SvgPath, LinesAndCurves_BecomePointsTurnedOver) {
    const auto points = read_svg_path("M10,10h 90 V20 l-90,0z").value();
    EXPECT_EQ(points, (std::vector<Point>{{10, -10}, {100, -10}, {100, -20}, {10, -20}}));
    const auto curve = read_svg_path("M0 0C100 0 100 100 0 100Z").value();
    EXPECT_GT(curve.size(), 50u);
    EXPECT_EQ(curve.back(), (Point{0, -100}));
    double far = 0;
    for (const auto& point : curve)
        far = std::max(far, point.x);
    EXPECT_NEAR(far, 75, 0.1);
}

TEST(SvgPath, WhatCannotBeRead_IsRefusedWithItsPlace) {
    EXPECT_THAT(read_svg_path("M 0 0 A 1 1").error(), HasSubstr("only M, L, H, V, C and Z"));
    EXPECT_THAT(read_svg_path("M 0 0 L 1").error(), HasSubstr("lacks a number (character 10)"));
    EXPECT_THAT(read_svg_path("L 0 0").error(), HasSubstr("begins with M"));
    EXPECT_THAT(read_svg_path("M 0 0 L 1 1 Z M 5 5").error(), HasSubstr("one closed line"));
    EXPECT_THAT(read_svg_path("M 0 nan").error(), HasSubstr("lacks a number"));
}

TEST(Rover, BothWheelsAlike_DrivesStraightOnAtItsSpeed) {
    RoverSpec spec;
    spec.lag_ms = 0;
    Rover rover(spec, {{0, 0}, kPi / 2});
    for (int i = 0; i < 1000; ++i)
        rover.step(0.5, 0.5, 0.001);
    EXPECT_NEAR(rover.pose().at.x, 0, 1e-9);
    EXPECT_NEAR(rover.pose().at.y, kPi * 60, 1e-6) << "one turn of a wheel in a second at half of 120 rpm";
    EXPECT_NEAR(rover.wheel(Rover::kLeft).turned, 2 * kPi, 1e-9);
}

TEST(Rover, WheelsAgainstEachOther_TurnsOnTheSpot) {
    RoverSpec spec;
    spec.lag_ms = 0;
    Rover rover(spec, {});
    const double quarter = kPi / 4 * spec.base_mm / (rover.top_speed() / 2) * 1000 / 2;
    for (int i = 0; i < 1000; ++i)
        rover.step(-0.5, 0.5, quarter / 1e6 * 2);
    EXPECT_NEAR(rover.pose().heading, kPi / 2, 1e-6);
    EXPECT_NEAR(length(rover.pose().at), 0, 1e-6);
}

TEST(Rover, Lag_IsExactWhateverTheStep) {
    RoverSpec spec;
    spec.lag_ms = 60;
    Rover fine(spec, {}), coarse(spec, {});
    for (int i = 0; i < 100; ++i)
        fine.step(1, 1, 0.001);
    for (int i = 0; i < 10; ++i)
        coarse.step(1, 1, 0.01);
    EXPECT_NEAR(fine.pose().at.x, coarse.pose().at.x, 1e-9);
    const double top = fine.top_speed(), rest = std::exp(-0.1 / 0.06);
    EXPECT_NEAR(fine.pose().at.x, top * (0.1 - 0.06 * (1 - rest)), 1e-9);
}

TEST(Rover, DeadBandAndSlip_TakeTheirShare) {
    RoverSpec spec;
    spec.lag_ms = 0;
    spec.dead_band = 0.1;
    spec.slip = 0.25;
    Rover rover(spec, {});
    rover.step(0.09, 0.09, 1);
    EXPECT_EQ(rover.pose().at.x, 0);
    rover.step(1, 1, 1);
    EXPECT_NEAR(rover.pose().at.x, 0.75 * rover.top_speed(), 1e-9);
    EXPECT_NEAR(rover.wheel(Rover::kLeft).turned, 4 * kPi, 1e-9) << "the wheels turn all of it";
}

TEST(LapCounter, OnceAround_IsALapWithItsError) {
    const auto track = Track::create(square(), 20).value();
    LapCounter counter(track, 40);
    unsigned laps = 0;
    Lap lap;
    for (int i = 0; i <= 4000; ++i) {
        const auto pose = track.at(i);
        if (const auto seen = counter.step(beside(pose, 0, 3), 0.005); seen.lap) {
            ++laps;
            lap = *seen.lap;
        }
    }
    EXPECT_EQ(laps, 1u);
    EXPECT_NEAR(lap.seconds, 20, 0.05);
    EXPECT_NEAR(lap.rms_mm, 3, 0.01);
    EXPECT_NEAR(lap.max_mm, 3, 0.01);
}

TEST(LapCounter, LeavingTheLine_IsToldOnceAndTheLapBeginsAnew) {
    const auto track = Track::create(square(), 20).value();
    LapCounter counter(track, 40);
    counter.step({100, 0}, 0.01);
    EXPECT_TRUE(counter.step({100, 41}, 0.01).left);
    EXPECT_FALSE(counter.on_track());
    EXPECT_FALSE(counter.step({100, 60}, 0.01).left);
    EXPECT_TRUE(counter.step({900, 10}, 0.01).returned);
    for (int i = 901; i < 4800; ++i)
        EXPECT_FALSE(counter.step(track.at(i).at, 0.01).lap) << i;
    EXPECT_TRUE(counter.step(track.at(4901).at, 0.01).lap);
}

TEST(World, SensorsAcrossTheLine_SeeItInTheMiddleAndAtTheSides) {
    const auto world = World::create(square_world()).value();
    const auto rover = world->add_on_line(300);
    const auto straight = world->reflectance(rover);
    EXPECT_EQ(straight[1], 900);
    EXPECT_EQ(straight[0], straight[2]);
    world->place(rover, {{300, 9.5}, 0});  // too far to the left: the right one is on the line
    const auto left = world->reflectance(rover);
    EXPECT_EQ(left[2], 900);
    EXPECT_EQ(left[0], 25);
}

TEST(World, Noise_IsTheSameForTheSameSeed) {
    auto spec = square_world();
    spec.rover.noise = 10;
    const auto one = World::create(spec).value(), same = World::create(spec).value();
    spec.seed = 2;
    const auto other = World::create(spec).value();
    for (const auto& world : {one, same, other})
        world->add_on_line(0);
    const auto values = one->reflectance(0);
    EXPECT_EQ(values, same->reflectance(0));
    EXPECT_NE(values, other->reflectance(0));
    EXPECT_NE(values, one->reflectance(0));
}

TEST(World, ObstacleAhead_IsMeasuredStopsTheRoverAndPressesBothBumpers) {
    const auto world = World::create(square_world()).value();
    const auto rover = world->add({{0, 500}, 0});
    EXPECT_FALSE(world->distance(rover, 0));
    world->block({{500, 500}, 50});
    EXPECT_NEAR(world->distance(rover, 0).value(), 500 - 50 - 90, 1e-9);
    EXPECT_FALSE(world->distance(rover, kPi / 2)) << "beside it";
    unsigned bumps = 0;
    for (int i = 0; i < 3000; ++i)
        bumps += world->step(rover, 0.5, 0.5, 0.001).bump ? 1 : 0;
    EXPECT_EQ(bumps, 1u);
    const auto stopped = world->state(rover);
    EXPECT_NEAR(stopped.pose.at.x, 500 - 50 - 90, 0.5);
    EXPECT_TRUE(stopped.bumped[0] && stopped.bumped[1]);
    EXPECT_GT(stopped.wheels[0].turned, 10) << "its wheels turn on";
    for (int i = 0; i < 500; ++i)
        world->step(rover, -0.5, -0.5, 0.001);
    EXPECT_FALSE(world->state(rover).bumped[0]);
    EXPECT_LT(world->state(rover).pose.at.x, 300);
}

TEST(World, ObstacleOnTheLeft_PressesTheLeftBumper) {
    const auto world = World::create(square_world()).value();
    const auto rover = world->add({{0, 0}, 0});
    world->block({{100, 80}, 30});
    for (int i = 0; i < 200; ++i)
        world->step(rover, 0.5, 0.5, 0.001);
    EXPECT_TRUE(world->state(rover).bumped[0]);
    EXPECT_FALSE(world->state(rover).bumped[1]);
}

TEST(World, Rovers_MeetEachOther) {
    const auto world = World::create(square_world()).value();
    const auto first = world->add({{0, 500}, 0});
    const auto second = world->add({{600, 500}, kPi});
    EXPECT_NEAR(world->distance(first, 0).value(), 600 - 180, 1e-9);
    for (int i = 0; i < 4000; ++i) {
        world->step(first, 0.5, 0.5, 0.001);
        world->step(second, 0.5, 0.5, 0.001);
    }
    EXPECT_NEAR(world->state(second).pose.at.x - world->state(first).pose.at.x, 180, 1);
    EXPECT_TRUE(world->state(first).bumped[0] && world->state(second).bumped[1]);
}

TEST(World, Picture_HasTheLineTheWayAndTheBumps) {
    auto spec = square_world();
    spec.obstacles = {{{500, 0}, 40}};
    const auto world = World::create(spec).value();
    const auto rover = world->add_on_line(100);
    for (int i = 0; i < 2000; ++i)
        world->step(rover, 0.5, 0.5, 0.001);
    const auto svg = picture(*world);
    EXPECT_THAT(svg, HasSubstr("<polygon"));
    EXPECT_THAT(svg, HasSubstr("<polyline stroke=\"hsl(130,85%,42%)\""));
    EXPECT_THAT(svg, HasSubstr("r=\"40.0\""));
    EXPECT_THAT(svg, HasSubstr("<path d=\"M"));
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

std::string fault_of(std::string_view text) {
    const auto world = parse_world(text, "w.json");
    return world ? "none" : world.error();
}

TEST(WorldFile, Folder_Refused) {
    EXPECT_EQ(load_world("/tmp").error(), "/tmp: cannot read the world file: is a folder");
}

TEST(WorldFile, MeasuresAndObstacles_AreRead) {
    const auto world = parse_world(R"({"track":{"line":[[0,0],[100,0],[0,100]],"width":10,"off":15},
        "rover":{"wheel":40,"noise":2},"obstacles":[{"x":1,"y":2,"r":3}],"seed":7})",
                                   "w.json")
                           .value();
    EXPECT_EQ(world->spec().rover.wheel_mm, 40);
    EXPECT_EQ(world->spec().rover.rpm, 120);
    EXPECT_EQ(world->spec().off_mm, 15);
    EXPECT_EQ(world->obstacles().size(), 1u);
    EXPECT_EQ(world->spec().seed, 7u);
}

TEST(WorldFile, WhatIsWrong_IsNamedWithItsPlace) {
    EXPECT_EQ(fault_of("{"), "w.json: is not correct JSON");
    EXPECT_EQ(fault_of("{}"), "w.json: /track: is missing");
    EXPECT_THAT(fault_of(R"({"track":{"line":[[0,0],[1,"a"]]}})"),
                HasSubstr("/track/line: [1,\"a\"] is not a point"));
    EXPECT_THAT(fault_of(R"({"track":{"line":[[0,0],[1,1]]}})"), HasSubstr("three different points"));
    EXPECT_THAT(fault_of(R"({"track":{"path":"M 0 0 Q 1 1"}})"), HasSubstr("/track/path: "));
    EXPECT_THAT(fault_of(R"({"track":{"path":"M 0 0 L 9 0 L 9 9"},"rover":{"weel":3}})"),
                HasSubstr("did you mean \"wheel\""));
    EXPECT_THAT(fault_of(R"({"track":{"path":"M 0 0 L 9 0 L 9 9"},"rover":{"wheel":0}})"),
                HasSubstr("/rover/wheel"));
}

}  // namespace
}  // namespace asip::sim::world
