// SPDX-License-Identifier: Apache-2.0
#include "sim/world/track.hpp"

#include <algorithm>

namespace asip::sim::world {
namespace {

/// The part of a disk of radius 1 that lies below the height `u`.
double disk_below(double u) {
    u = std::clamp(u, -1.0, 1.0);
    return 0.5 + (u * std::sqrt(1 - u * u) + std::asin(u)) / std::numbers::pi;
}

}  // namespace

Expected<Track> Track::create(std::vector<Point> line, double width_mm) {
    if (!(width_mm >= 1 && width_mm <= 200)) return fail("a line is 1 to 200 mm wide");
    line.erase(std::unique(line.begin(), line.end()), line.end());
    while (line.size() > 1 && line.front() == line.back())
        line.pop_back();
    if (line.size() < 3) return fail("a closed line needs at least three different points");
    std::vector<double> starts{0};
    for (std::size_t i = 0; i < line.size(); ++i)
        starts.push_back(starts.back() + length(line[(i + 1) % line.size()] - line[i]));
    return Track(std::move(line), std::move(starts), width_mm);
}

Track::Track(std::vector<Point> line, std::vector<double> starts, double width)
    : line_(std::move(line)), starts_(std::move(starts)), width_(width) {}

double Track::darkness(Point centre, double radius_mm) const {
    // The spot is small beside the line's curves: there the line is straight.
    const double distance = std::abs(nearest(centre).offset);
    const double half = width_ / 2;
    return disk_below((half - distance) / radius_mm) - disk_below((-half - distance) / radius_mm);
}

double Track::wrap(double along) const {
    const double rest = std::fmod(along, length_mm());
    return rest < 0 ? rest + length_mm() : rest;
}

Pose Track::at(double along) const {
    along = wrap(along);
    const auto next = std::upper_bound(starts_.begin() + 1, starts_.end() - 1, along);
    const auto side = static_cast<std::size_t>(next - starts_.begin()) - 1;
    const auto way = line_[(side + 1) % line_.size()] - line_[side];
    const double heading = std::atan2(way.y, way.x);
    return {line_[side] + (along - starts_[side]) * direction(heading), heading};
}

Track::Place Track::nearest_of_side(Point point, std::size_t side) const {
    const auto begin = line_[side];
    const auto way = line_[(side + 1) % line_.size()] - begin;
    const double size = starts_[side + 1] - starts_[side];
    const double along = std::clamp(dot(point - begin, way) / size, 0.0, size);
    const auto from = point - (begin + (along / size) * way);
    const double distance = length(from);
    return {starts_[side] + along, cross(way, from) < 0 ? -distance : distance};
}

Track::Place Track::nearest(Point point) const {
    auto best = nearest_of_side(point, 0);
    for (std::size_t side = 1; side < line_.size(); ++side) {
        const auto place = nearest_of_side(point, side);
        if (std::abs(place.offset) < std::abs(best.offset)) best = place;
    }
    best.along = wrap(best.along);
    return best;
}

Track::Place Track::nearest(Point point, double along, double reach) const {
    std::optional<Place> best;
    for (std::size_t side = 0; side < line_.size(); ++side) {
        const double size = starts_[side + 1] - starts_[side];
        // From the side's beginning to `along`, the short way round
        const double ahead = wrap(along - starts_[side]);
        if (std::min(ahead, length_mm() - ahead) > reach + size) continue;
        const auto place = nearest_of_side(point, side);
        if (!best || std::abs(place.offset) < std::abs(best->offset)) best = place;
    }
    if (!best) return nearest(point);
    best->along = wrap(best->along);
    return *best;
}

}  // namespace asip::sim::world
