// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "asip/bus/registry/items.hpp"
#include "asip/expected.hpp"

namespace asip::bus {

/// A change of a registry's catalogue. Within one epoch of one registry, events carry consecutive numbers: a
/// gap is a lost event.
struct ChangeEvent {
    enum class Kind {
        kAdded,        ///< board known for the first time
        kState,        ///< effective state: `was` -> board.state
        kDescription,  ///< services, chip, pins, ...: anything of the description but seq
        kConflict,     ///< board.conflict appeared or changed
        kResolved,     ///< conflict over
        kForgotten,    ///< board left the catalogue; only `board.board` holds anything
        kReset,        ///< no board: more changed than is reported one by one; take a new snapshot
    };
    Kind kind = Kind::kReset;
    std::string registry;   ///< its id
    std::string epoch;      ///< differs each time a registry starts counting anew
    std::uint64_t seq = 0;  ///< the number of this event
    text::WallTime at{};    ///< by the clock of the registry
    BoardItem board;        ///< as it is after the change (without description)
    std::string was;        ///< kState: effective state before
    /// kAdded, kState: why the board is in its state, a word of model::StateReason; may be empty.
    std::string reason;

    bool operator==(const ChangeEvent&) const = default;
};

/// "added", "state", "description", "conflict", "resolved", "forgotten", "reset"
std::string_view to_string(ChangeEvent::Kind kind);

/// The payload of the event.
std::string encode(const ChangeEvent& event);
/// Reads what encode() wrote, by whichever version. Fails when it is not a JSON object, or of an unknown
/// kind.
Expected<ChangeEvent> parse_change_event(std::string_view payload);

}  // namespace asip::bus
