// SPDX-License-Identifier: Apache-2.0
#include "sim/world/outline.hpp"

#include <algorithm>

namespace asip::sim::world {
namespace {

constexpr double kToleranceMm = 0.15;
/// So many points in a row are left out at most: it bounds the time.
constexpr std::size_t kMaxRun = 100;

double distance_from_side(Point point, Point from, Point to) {
    const auto side = to - from;
    const double squared = dot(side, side);
    const double share = squared > 0 ? std::clamp(dot(point - from, side) / squared, 0.0, 1.0) : 0;
    return length(point - (from + share * side));
}

bool is_straight(const std::vector<Point>& line, std::size_t from, std::size_t to, double tolerance) {
    if (to - from > kMaxRun) return false;
    for (auto i = from + 1; i < to; ++i)
        if (distance_from_side(line[i], line[from], line[to]) > tolerance) return false;
    return true;
}

std::vector<Point> thinned(const std::vector<Point>& line, double tolerance) {
    std::vector<Point> kept{line.front()};
    std::size_t from = 0;
    for (std::size_t i = 1; i < line.size(); ++i) {
        if (i + 1 < line.size() && is_straight(line, from, i + 1, tolerance)) continue;
        kept.push_back(line[i]);
        from = i;
    }
    return kept;
}

}  // namespace

std::vector<Point> outline(const std::vector<Point>& line, std::size_t most) {
    auto kept = thinned(line, kToleranceMm);
    for (double tolerance = 2 * kToleranceMm; kept.size() > most; tolerance *= 2)
        kept = thinned(line, tolerance);
    return kept;
}

}  // namespace asip::sim::world
