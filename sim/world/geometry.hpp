// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <numbers>

namespace asip::sim::world {

/// A place on the floor in millimetres: x to the right, y up, as a person draws it.
struct Point {
    double x = 0;
    double y = 0;
    bool operator==(const Point&) const = default;
};

inline Point operator+(Point a, Point b) {
    return {a.x + b.x, a.y + b.y};
}
inline Point operator-(Point a, Point b) {
    return {a.x - b.x, a.y - b.y};
}
inline Point operator*(double factor, Point p) {
    return {factor * p.x, factor * p.y};
}
inline double dot(Point a, Point b) {
    return a.x * b.x + a.y * b.y;
}
/// Positive where b lies to the left of a.
inline double cross(Point a, Point b) {
    return a.x * b.y - a.y * b.x;
}
inline double length(Point p) {
    return std::hypot(p.x, p.y);
}
/// One millimetre in a direction, in radians counter-clockwise from x.
inline Point direction(double angle) {
    return {std::cos(angle), std::sin(angle)};
}
inline double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}
/// 0 up to 360.
inline double degrees(double radians) {
    const double turned = std::fmod(radians * 180 / std::numbers::pi, 360);
    return turned < 0 ? turned + 360 : turned;
}

/// Where something stands and where it looks: radians counter-clockwise from x.
struct Pose {
    Point at;
    double heading = 0;
};

/// `ahead` and `left` of a pose, in millimetres.
inline Point beside(const Pose& pose, double ahead, double left) {
    return pose.at + ahead * direction(pose.heading) + left * direction(pose.heading + std::numbers::pi / 2);
}

}  // namespace asip::sim::world
