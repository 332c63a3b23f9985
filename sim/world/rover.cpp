// SPDX-License-Identifier: Apache-2.0
#include "sim/world/rover.hpp"

namespace asip::sim::world {

double Rover::top_speed() const {
    return spec_.rpm / 60 * std::numbers::pi * spec_.wheel_mm;
}

/// Radians that the wheel turned.
double Rover::advance(Wheel& wheel, double power, double seconds) const {
    const double wanted = std::abs(power) < spec_.dead_band ? 0 : power;
    const double target = wanted * spec_.rpm / 60 * 2 * std::numbers::pi;
    const double lag = spec_.lag_ms / 1000;
    // The exact way of a first-order lag, whatever the step
    const double rest = lag > 0 ? std::exp(-seconds / lag) : 0;
    const double turned = target * seconds + (wheel.speed - target) * lag * (1 - rest);
    wheel.speed = target + (wheel.speed - target) * rest;
    wheel.turned += turned;
    return turned;
}

void Rover::step(double left, double right, double seconds) {
    const double grip = (1 - spec_.slip) * spec_.wheel_mm / 2;
    const double left_way = advance(wheels_[kLeft], left, seconds) * grip;
    const double right_way = advance(wheels_[kRight], right, seconds) * grip;
    const double turn = (right_way - left_way) / spec_.base_mm;
    const double middle = pose_.heading + turn / 2;
    pose_.at = pose_.at + (left_way + right_way) / 2 * direction(middle);
    pose_.heading = std::remainder(pose_.heading + turn, 2 * std::numbers::pi);
}

void Rover::place(const Pose& pose) {
    pose_ = pose;
    for (auto& wheel : wheels_)
        wheel.speed = 0;
}

}  // namespace asip::sim::world
