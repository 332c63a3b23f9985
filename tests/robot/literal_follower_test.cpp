// SPDX-License-Identifier: Apache-2.0
// The published line followers, byte for byte as their libraries put them on the serial line, on the robots
// that they were written for.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "sim/board.hpp"
#include "sim/world/world_file.hpp"

namespace asip::test {
namespace {

using namespace std::chrono_literals;

/// What they decide each 50 ms: IR 2, 1 and 0 are left, middle and right; values below 50 are floor; whole
/// numbers wherever the programs have them.
class PublishedFollower {
  public:
    /// The left motor's and the right one's, which is mounted the other way round.
    std::array<int, 2> powers(const std::array<int, 3>& ir) {
        const auto cut = [](int value) { return value < 50 ? 0 : value; };
        const int left = cut(ir[2]), middle = cut(ir[1]), right = cut(ir[0]);
        if (left + middle + right > 0) error_ = (middle * 2000.0 + right * 4000.0) / (left + middle + right);
        const int delta = std::clamp(static_cast<int>(std::floor(0.015 * (error_ - 2000))), -50, 50);
        if (delta < 0) return {static_cast<int>(2.55 * (50 + delta)), static_cast<int>(2.55 * -50)};
        return {static_cast<int>(2.55 * 50), static_cast<int>(-(50 - delta) * 2.55)};
    }

  private:
    double error_ = 2000;
};

struct Library {
    std::string line_end;  ///< of the requests of its services
    int left, right;       ///< the numbers that its motors have on the wire
    nlohmann::json robot;  ///< how the rover is wired
};

struct Lapped {
    unsigned laps = 0;
    bool stayed = true;
    sim::world::Lap last{};
};

Lapped drive(const Library& library, unsigned laps) {
    auto world = sim::world::load_world(ASIP_TRACK).value();
    sim::BoardConfig config;
    config.image = ASIP_MIRTO;
    config.parts = {{"rover", library.robot, "rover"}};
    config.world = world;
    auto board = std::move(sim::Board::create(config).value());
    board->run_for(2500ms);  // the programs wait for the boot loader
    board->take_output();
    const auto write = [&](const std::string& request) { board->send(request + library.line_end); };
    board->send("I,M\n");
    board->run_for(500ms);
    board->send("I,A,0\n");
    for (const char* request : {"E,A,25", "E,A,25", "R,A,25", "R,A,25", "R,A,25", "B,A,25", "B,A,25"})
        write(request);
    PublishedFollower follower;
    Lapped result;
    std::array<int, 3> ir{};
    std::string received;
    const auto began = board->now();
    while (result.laps < laps && result.stayed && board->now() - began < 60s) {
        for (int i = 0; i < 50; ++i) {
            board->run_for(1ms);
            received += board->take_output();
        }
        const auto last = received.rfind("@R,e,3,{");
        if (last != std::string::npos && received.find('\n', last) != std::string::npos) {
            std::sscanf(received.c_str() + last, "@R,e,3,{%d,%d,%d}", &ir[0], &ir[1], &ir[2]);
            received.erase(0, last);
        }
        const auto powers = follower.powers(ir);
        write(fmt::format("M,m,{},{}", library.left, powers[0]));
        write(fmt::format("M,m,{},{}", library.right, powers[1]));
        const auto rover = world->state(0);
        result = {rover.laps, rover.on_track, rover.last_lap};
    }
    return result;
}

const nlohmann::json kDefault = nlohmann::json::object();
const nlohmann::json kMotorsExchanged{{"motors", {12, 13, 6, 8, 11, 5}}};
const nlohmann::json kIr0Left{{"reflectance", {14, 15, 16, 17}}};

TEST(LiteralFollower, OfJavaAsip_LapsOnTheDefaultRobot) {
    const auto driven = drive({"\n", 0, 1, kDefault}, 2);
    EXPECT_EQ(driven.laps, 2u);
    EXPECT_NEAR(driven.last.seconds, 18.925, 0.3) << "docs/robot.md";
    EXPECT_NEAR(driven.last.rms_mm, 7.69, 0.5) << "docs/robot.md";
}

TEST(LiteralFollower, OfPythonAsipWithoutLineEnds_LapsOnItsRobot) {
    const auto driven = drive({"", 1, 0, kMotorsExchanged}, 2);
    EXPECT_EQ(driven.laps, 2u);
    EXPECT_NEAR(driven.last.seconds, 19.072, 0.3) << "docs/robot.md";
    EXPECT_NEAR(driven.last.rms_mm, 7.64, 0.5) << "docs/robot.md";
}

TEST(LiteralFollower, OnARobotWiredOtherwise_LeavesTheLine) {
    EXPECT_FALSE(drive({"\n", 0, 1, kIr0Left}, 1).stayed);
}

}  // namespace
}  // namespace asip::test
