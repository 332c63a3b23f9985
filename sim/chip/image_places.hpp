// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "sim/chip/image.hpp"

namespace asip::sim {

/// Where the two readers put bytes. False if they do not fit the largest AVR.
bool place_in_flash(Image& image, std::size_t address, const std::uint8_t* data, std::size_t size);
bool place_in_eeprom(Image& image, std::size_t address, const std::uint8_t* data, std::size_t size);

}  // namespace asip::sim
