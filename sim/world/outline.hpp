// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

#include "sim/world/geometry.hpp"

namespace asip::sim::world {

/// A closed line with fewer points, for a picture: at most `most` (200 or more) of its own, and none of those
/// that were left out is further than 0.15 mm from it, or as little more as `most` allows.
std::vector<Point> outline(const std::vector<Point>& line, std::size_t most);

}  // namespace asip::sim::world
