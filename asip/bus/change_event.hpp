#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "asip/bus/items.hpp"
#include "asip/expected.hpp"

namespace asip::bus {

/// A change of the catalogue of registry `registry`. Within an epoch events carry consecutive numbers.
struct ChangeEvent {
    enum class Kind {
        kAdded,        ///< board known for the first time
        kState,        ///< effective state: `was` -> board.state
        kDescription,  ///< services, chip, pins, ...: anything of the description but seq
        kConflict,     ///< board.conflict appeared or changed
        kResolved,     ///< conflict over
        kForgotten,    ///< board left the catalogue; only `board.board` holds anything
        kReset,        ///< no board: more changed than is told one by one; take a new snapshot
    };
    Kind kind = Kind::kReset;
    std::string registry;
    std::string epoch;
    std::uint64_t seq = 0;
    text::WallTime at{};
    BoardItem board;  ///< as it is after the change (without description)
    std::string was;  ///< kState: effective state before
    /// kState: "said", "will", "lease", "announced", "retained"; else as fits, may be empty.
    std::string reason;

    bool operator==(const ChangeEvent&) const = default;
};

/// "added", "state", "description", "conflict", "resolved", "forgotten", "reset"
std::string_view to_string(ChangeEvent::Kind kind);

std::string encode(const ChangeEvent& event);
Expected<ChangeEvent> parse_change_event(std::string_view payload);

}  // namespace asip::bus
