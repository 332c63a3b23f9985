#pragma once
#include "asip/expected.hpp"
#include "sim/board_kind.hpp"
#include "sim/config.hpp"

namespace asip::sim {

/// Which part cannot be wired, and why.
struct PartFault {
    std::size_t index;  ///< in BoardConfig::parts
    std::string reason;
};

/// Whether the parts can be wired as asked: every pin exists, is free, can do it, and each name is used once.
Expected<void, PartFault> check_parts(const BoardConfig& config, const BoardKind& kind);

}  // namespace asip::sim
