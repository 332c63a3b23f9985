// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

#include "sim/board_kind.hpp"
#include "sim/chip/image.hpp"

namespace asip::sim {

/// It fits, and its vector table is of this chip.
Expected<void> check_chip(const Image& image, const BoardKind& kind, std::size_t flash_bytes);

}  // namespace asip::sim
