// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "sim/board.hpp"

namespace asip::sim {

/// As a programmer does: the rest of the flash is erased, the EEPROM stays unless the image has one.
/// Board::symbol() knows the old image. After an error nothing has changed.
Expected<void> load_into(Board& board, const std::filesystem::path& image);

}  // namespace asip::sim
