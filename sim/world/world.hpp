// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <vector>

#include "sim/world/laps.hpp"
#include "sim/world/rover.hpp"
#include "sim/world/track.hpp"

namespace asip::sim::world {

/// A round thing that a rover cannot pass.
struct Obstacle {
    Point at;
    double radius_mm = 0;
    bool operator==(const Obstacle&) const = default;
};

/// What a world consists of at its start.
struct WorldSpec {
    std::vector<Point> line;
    double width_mm = 19;  ///< of the line: electrical tape
    double off_mm = 40;    ///< further from the middle of the line than this is off the track
    RoverSpec rover;       ///< of each
    std::vector<Obstacle> obstacles;
    unsigned seed = 1;  ///< of the sensors' noise
};

/// Where a rover has been, for a picture.
struct TrailPoint {
    Point at;              ///< middle of the sensors
    double offset_mm = 0;  ///< from the middle of the line
    bool jump = false;     ///< it was put here
};
struct Trail {
    std::deque<TrailPoint> points;  ///< each 4 mm, the newest 20,000
    std::deque<Point> bumps;        ///< the newest 1,000
};

/// A floor with a line on it, obstacles, and any number of rovers that see and push each other. Nothing moves
/// but by step(). The rovers of one world may be on boards of several threads: each call locks.
class World {
  public:
    using RoverId = std::size_t;

    /// The error is a sentence about the track.
    static Expected<std::shared_ptr<World>> create(const WorldSpec& spec);

    const Track& track() const { return track_; }
    const WorldSpec& spec() const { return spec_; }

    /// Its sensors stand above the line, `along` millimetres from the line's first point.
    RoverId add_on_line(double along);
    RoverId add(const Pose& pose);

    /// What a rover is after a step, and what happened in it.
    struct State {
        Pose pose;
        std::array<Wheel, 2> wheels;
        std::array<bool, 2> bumped{};  ///< left, right bumper
        bool on_track = true;
        double offset_mm = 0;
        unsigned laps = 0;
        Lap last_lap;  ///< of those
    };
    struct Happened {
        LapCounter::Seen track;
        bool bump = false;  ///< touched something just now
    };
    /// Lets time pass for one rover, at most 10 ms in a call: power -1 to 1 at each wheel, forwards positive.
    Happened step(RoverId rover, double left, double right, double seconds);
    State state(RoverId rover) const;

    /// The values of its reflectance sensors from left to right, 0 to 1023, with noise.
    std::array<int, 3> reflectance(RoverId rover);
    /// Millimetres from its front to whatever is there in the direction of `bearing` (radians, left of its
    /// heading positive); none if nothing is.
    std::optional<double> distance(RoverId rover, double bearing) const;

    void place(RoverId rover, const Pose& pose);
    /// `x` and `y` and a radius above 0, in millimetres.
    void block(const Obstacle& obstacle);
    /// Takes all obstacles away.
    void clear();

    std::vector<Obstacle> obstacles() const;
    std::vector<State> rovers() const;
    std::vector<Trail> trails() const;

  private:
    struct Member {
        Rover rover;
        LapCounter laps;
        Trail trail;
        std::array<bool, 2> bumped{};
        std::mt19937 noise;
        bool jumped = true;
    };

    World(WorldSpec spec, Track track) : spec_(std::move(spec)), track_(std::move(track)) {}
    State state_of(const Member& member) const;
    Point sensors_of(const Member& member) const;
    void touch(Member& member, const Pose& before);
    void draw(Member& member, bool bump);
    std::vector<Obstacle> others(const Member& member) const;
    double noise(Member& member) const;

    WorldSpec spec_;
    Track track_;
    std::vector<Obstacle> obstacles_;
    std::deque<Member> members_;
    mutable std::mutex mutex_;
};

}  // namespace asip::sim::world
