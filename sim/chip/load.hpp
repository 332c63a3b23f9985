// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "sim/board.hpp"

namespace asip::sim {

/// Puts another image into the board's flash and restarts it, as a programmer does: the rest of the flash is
/// erased, the EEPROM stays unless the image brings one along. Board::symbol() still knows the old image. The
/// error is one line; then nothing has changed.
Expected<void> load_into(Board& board, const std::filesystem::path& image);

}  // namespace asip::sim
