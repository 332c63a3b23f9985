// SPDX-License-Identifier: Apache-2.0
#include "registry/values/timeline.hpp"

#include <algorithm>
#include <cstdlib>

namespace asip::registry {
namespace {

constexpr Tick kTicksOfHour = 3'600'000;

std::int64_t wall_ticks(Instant now) {
    return std::max<std::int64_t>(0, now.wall.time_since_epoch().count());
}

}  // namespace

void Timeline::begin(std::optional<Tick> last, Instant now) {
    const auto wall = wall_ticks(now);
    start_ = wall;
    if (last) {
        const Tick next = std::max<Tick>(0, *last);
        start_ = next + ((wall - next) % kTicksOfHour + kTicksOfHour) % kTicksOfHour;
    }
    offset_ = wall - start_;
    began_ = now;
}

Tick Timeline::at(Time time) const {
    return start_ + std::chrono::duration_cast<std::chrono::milliseconds>(time - began_.time).count();
}

std::int64_t Timeline::ahead(Instant now) const {
    return wall_ticks(now) - (at(now.time) + offset_);
}

Tick Timeline::by_clock(Instant now) const {
    const auto differs = ahead(now);
    return at(now.time) + (std::abs(differs) <= kSetBy ? differs : 0);
}

bool Timeline::tick(Instant now) {
    const auto set_by = ahead(now);
    if (std::abs(set_by) <= kSetBy) return false;
    if (now.time - began_.time <= kCorrects) {
        offset_ += set_by;
        return false;
    }
    begin(at(now.time), now);
    return true;
}

}  // namespace asip::registry
