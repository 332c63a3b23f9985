// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

#include "sim/board_kind.hpp"
#include "sim/chip/image.hpp"

namespace asip::sim {

/// Whether an image can run on a board whose chip has `flash_bytes`: it fits, and its table of interrupt
/// vectors is not that of another chip, whose registers and stack lie elsewhere.
Expected<void> check_chip(const Image& image, const BoardKind& kind, std::size_t flash_bytes);

}  // namespace asip::sim
