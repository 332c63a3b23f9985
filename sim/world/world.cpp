// SPDX-License-Identifier: Apache-2.0
#include "sim/world/world.hpp"

#include <algorithm>

namespace asip::sim::world {
namespace {

constexpr double kTrailMm = 4;
constexpr std::size_t kMaxTrail = 20'000;
constexpr std::size_t kMaxBumps = 1'000;
// What is straight ahead presses both bumpers.
constexpr double kBothRadians = 0.26;

}  // namespace

Expected<std::shared_ptr<World>> World::create(const WorldSpec& spec) {
    auto track = Track::create(spec.line, spec.width_mm);
    if (!track) return fail(track.error());
    auto world = std::shared_ptr<World>(new World(spec, std::move(*track)));
    world->obstacles_ = spec.obstacles;
    return world;
}

World::RoverId World::add_on_line(double along) {
    auto pose = track_.at(along);
    pose.at = beside(pose, -spec_.rover.sensor_ahead_mm, 0);
    return add(pose);
}

World::RoverId World::add(const Pose& pose) {
    const std::scoped_lock lock(mutex_);
    const auto seed = spec_.seed + static_cast<unsigned>(members_.size());
    members_.push_back(
        {Rover(spec_.rover, pose), LapCounter(track_, spec_.off_mm), {}, {}, std::mt19937(seed), true});
    return members_.size() - 1;
}

Point World::sensors_of(const Member& member) const {
    return beside(member.rover.pose(), spec_.rover.sensor_ahead_mm, 0);
}

World::Happened World::step(RoverId rover, double left, double right, double seconds) {
    const std::scoped_lock lock(mutex_);
    auto& member = members_.at(rover);
    const auto before = member.rover.pose();
    const auto bumped = member.bumped;
    member.rover.step(left, right, seconds);
    touch(member, before);
    Happened happened;
    happened.bump = (member.bumped[0] && !bumped[0]) || (member.bumped[1] && !bumped[1]);
    happened.track = member.laps.step(sensors_of(member), seconds);
    draw(member, happened.bump);
    return happened;
}

/// Everything that the rover cannot pass: obstacles and other rovers.
std::vector<Obstacle> World::others(const Member& member) const {
    auto things = obstacles_;
    for (const auto& other : members_)
        if (&other != &member) things.push_back({other.rover.pose().at, spec_.rover.radius_mm});
    return things;
}

/// A rover that would drive further into something stays where it was; it may turn and draw back.
void World::touch(Member& member, const Pose& before) {
    member.bumped = {};
    const auto after = member.rover.pose();
    for (const auto& thing : others(member)) {
        const auto way = thing.at - after.at;
        const double room = length(way) - thing.radius_mm - spec_.rover.radius_mm;
        if (room > 0) continue;
        const double bearing = std::remainder(std::atan2(way.y, way.x) - after.heading, 2 * std::numbers::pi);
        if (std::abs(bearing) < std::numbers::pi / 2) {
            member.bumped[Rover::kLeft] |= bearing > -kBothRadians;
            member.bumped[Rover::kRight] |= bearing < kBothRadians;
        }
        if (length(thing.at - before.at) >= length(way)) member.rover.hold_at({before.at, after.heading});
    }
}

void World::draw(Member& member, bool bump) {
    auto& trail = member.trail;
    const auto at = sensors_of(member);
    if (trail.points.empty() || member.jumped || length(at - trail.points.back().at) >= kTrailMm) {
        trail.points.push_back({at, member.laps.offset_mm(), member.jumped});
        member.jumped = false;
        if (trail.points.size() > kMaxTrail) trail.points.pop_front();
    }
    if (!bump) return;
    trail.bumps.push_back(beside(member.rover.pose(), spec_.rover.radius_mm, 0));
    if (trail.bumps.size() > kMaxBumps) trail.bumps.pop_front();
}

World::State World::state_of(const Member& member) const {
    return {member.rover.pose(),     {member.rover.wheel(Rover::kLeft), member.rover.wheel(Rover::kRight)},
            member.bumped,           member.laps.on_track(),
            member.laps.offset_mm(), member.laps.laps(),
            member.laps.last_lap()};
}

World::State World::state(RoverId rover) const {
    const std::scoped_lock lock(mutex_);
    return state_of(members_.at(rover));
}

/// Noise of standard deviation 1, from twelve even ones: the same with each C++ library.
double World::noise(Member& member) const {
    double sum = -6;
    for (int i = 0; i < 12; ++i)
        sum += static_cast<double>(member.noise()) / 4294967296.0;
    return sum;
}

std::array<int, 3> World::reflectance(RoverId rover) {
    const std::scoped_lock lock(mutex_);
    auto& member = members_.at(rover);
    const auto& measures = spec_.rover;
    std::array<int, 3> values{};
    for (int i = 0; i < 3; ++i) {
        const auto spot =
            beside(member.rover.pose(), measures.sensor_ahead_mm, (1 - i) * measures.sensor_pitch_mm);
        double value =
            measures.white + track_.darkness(spot, measures.spot_mm) * (measures.black - measures.white);
        if (measures.noise > 0) value += noise(member) * measures.noise;
        values[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(std::clamp(value, 0.0, 1023.0)));
    }
    return values;
}

std::optional<double> World::distance(RoverId rover, double bearing) const {
    const std::scoped_lock lock(mutex_);
    const auto& member = members_.at(rover);
    const auto pose = member.rover.pose();
    const auto front = beside(pose, spec_.rover.radius_mm, 0);
    const auto ray = direction(pose.heading + bearing);
    std::optional<double> nearest;
    for (const auto& thing : others(member)) {
        const auto way = thing.at - front;
        const double along = dot(way, ray), aside = cross(ray, way);
        const double half_chord = thing.radius_mm * thing.radius_mm - aside * aside;
        if (along <= 0 || half_chord < 0) continue;
        const double distance = std::max(0.0, along - std::sqrt(half_chord));
        if (!nearest || distance < *nearest) nearest = distance;
    }
    return nearest;
}

void World::place(RoverId rover, const Pose& pose) {
    const std::scoped_lock lock(mutex_);
    auto& member = members_.at(rover);
    member.rover.place(pose);
    member.laps.restart();
    member.jumped = true;
}

void World::block(const Obstacle& obstacle) {
    const std::scoped_lock lock(mutex_);
    obstacles_.push_back(obstacle);
}

void World::clear() {
    const std::scoped_lock lock(mutex_);
    obstacles_.clear();
}

std::vector<Obstacle> World::obstacles() const {
    const std::scoped_lock lock(mutex_);
    return obstacles_;
}

std::vector<World::State> World::rovers() const {
    const std::scoped_lock lock(mutex_);
    std::vector<State> states;
    for (const auto& member : members_)
        states.push_back(state_of(member));
    return states;
}

std::vector<Trail> World::trails() const {
    const std::scoped_lock lock(mutex_);
    std::vector<Trail> trails;
    for (const auto& member : members_)
        trails.push_back(member.trail);
    return trails;
}

}  // namespace asip::sim::world
