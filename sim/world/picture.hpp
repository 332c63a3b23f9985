// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "sim/world/world.hpp"

namespace asip::sim::world {

/// The world as an SVG document, a millimetre a unit: the line, the way of each rover coloured by its
/// distance from the middle of the line (green on it, red at half of what is off the track and beyond),
/// obstacles, crosses where it bumped, and the rovers themselves.
std::string picture(const World& world);

}  // namespace asip::sim::world
