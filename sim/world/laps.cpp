// SPDX-License-Identifier: Apache-2.0
#include "sim/world/laps.hpp"

#include <algorithm>

namespace asip::sim::world {
namespace {

constexpr double kReachMm = 100;  // far more than anything moves in one step

}  // namespace

void LapCounter::restart() {
    along_.reset();
    way_ = time_ = squares_ = max_ = 0;
}

LapCounter::Seen LapCounter::step(Point point, double seconds) {
    Seen seen;
    const auto place = along_ ? track_.nearest(point, *along_, kReachMm) : track_.nearest(point);
    offset_ = place.offset;
    const double distance = std::abs(place.offset);
    if (distance > off_mm_) {
        seen.left = on_track_;
        on_track_ = false;
        restart();
        return seen;
    }
    seen.returned = !on_track_;
    on_track_ = true;
    if (along_) {
        way_ += std::remainder(place.along - *along_, track_.length_mm());
        time_ += seconds;
        squares_ += distance * distance * seconds;
        max_ = std::max(max_, distance);
    }
    along_ = place.along;
    if (std::abs(way_) < track_.length_mm()) return seen;
    last_ = {time_, std::sqrt(squares_ / time_), max_};
    seen.lap = last_;
    ++laps_;
    way_ -= std::copysign(track_.length_mm(), way_);
    time_ = squares_ = max_ = 0;
    return seen;
}

}  // namespace asip::sim::world
