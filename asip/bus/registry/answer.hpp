// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/expected.hpp"

namespace asip::bus {

/// To a query or a forget. A refusal has `refused` and `error`, else only `id` and `registry`.
struct Answer {
    std::string id;        ///< of the request
    std::string registry;  ///< the one that answers
    std::string epoch;     ///< differs each time a registry starts counting anew
    /// The items hold after the change events of `epoch` up to this number. In a burst they may hold later
    /// changes, whose events follow and say nothing new.
    std::uint64_t seq = 0;
    bool settling = false;      ///< the registry is still reading what the broker retains: more will come
    Find find = Find::kBoards;  ///< what the items are, also where there are none
    std::optional<std::size_t> total;  ///< all matches, where asked for or known anyway
    std::vector<BoardItem> boards;
    /// Set: the query was brief, and `boards` is empty. Older registries answer with `boards`.
    std::optional<BriefRows> brief;
    std::vector<ServiceItem> services;
    std::vector<HistoryItem> history;
    std::vector<ValuePoint> values;  ///< of one property, in their order
    /// What these were made of: "changes", "minutes" or "hours"; empty: nothing is kept of it.
    std::string level;
    std::vector<KeptProperty> kept;      ///< properties of which values are kept
    std::vector<std::string> models;     ///< service models, each a JSON object as text
    std::vector<std::string> forgotten;  ///< board names
    std::string cursor;                  ///< for the next page; empty: this was the last
    /// For programs: "invalid", "alive", "unknown-board", "no-history", "queue-full"; empty: not refused.
    std::string refused;
    std::string error;  ///< the reason in a sentence for a person

    bool operator==(const Answer&) const = default;
};

/// What is empty is left out.
std::string encode(const Answer& answer);
/// Takes any version: unknown members are passed over, missing or mistyped ones are empty. Fails where it is
/// no JSON object of at most 16 MiB, or its rows are wrong.
Expected<Answer> parse_answer(std::string_view payload);

/// A change of a registry's catalogue. Numbers are consecutive within an epoch: a gap is a lost event.
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
    /// With kAdded and kState, a word of model::StateReason; may be empty.
    std::string reason;

    bool operator==(const ChangeEvent&) const = default;
};

std::string_view to_string(ChangeEvent::Kind kind);

std::string encode(const ChangeEvent& event);
/// Takes any version. Fails where it is no JSON object, or of an unknown kind.
Expected<ChangeEvent> parse_change_event(std::string_view payload);

}  // namespace asip::bus
