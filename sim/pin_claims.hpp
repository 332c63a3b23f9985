#pragma once
#include "asip/expected.hpp"
#include "sim/board_kind.hpp"
#include "sim/config.hpp"

namespace asip::sim {

/// Whether the parts can be wired as asked: every pin exists, is free, can do it, and each name is used once.
/// The error begins with the part's name.
Expected<void> check_parts(const BoardConfig& config, const BoardKind& kind);

}  // namespace asip::sim
