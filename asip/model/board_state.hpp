// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

namespace asip::model {

/// The state of a board, as its retained `$state` topic holds it.
enum class BoardState {
    kOnline,
    kOffline,   ///< its agent ended in order
    kLost,      ///< the broker published the will of its agent, or its lease ran out
    kSleeping,  ///< alive, but does not answer for a while
    kUpdating,  ///< alive, and being given new firmware
};

/// The word on the bus: "online", "offline", "lost", "sleeping", "updating".
std::string_view to_text(BoardState state);
/// From exactly that word; nothing otherwise.
std::optional<BoardState> board_state_from_text(std::string_view text);

/// Whether a board in this state is there, as long as its lease runs.
constexpr bool is_there(BoardState state) {
    return state != BoardState::kOffline && state != BoardState::kLost;
}
/// The opposite, of a word that a view shows: "unknown", or one of a later version, is no board that is gone.
bool is_gone(std::string_view word);
/// Whether a board that a view shows in this state takes commands: it is there, and its port is in nobody
/// else's hands.
bool takes_commands(std::string_view word);

/// Why a board is in its state. It is part of the state: each view shows it.
enum class StateReason {
    kNone,       ///< nothing to explain, or not known
    kUnplugged,  ///< the agent's port is gone, or its connection to the board
    kSilent,     ///< the port is there, and the board answers nothing
    kAgentGone,  ///< the agent ended without a goodbye, or lost the broker: its will was published
    kExpired,    ///< nothing renewed the lease
    kReleased,   ///< another program has the port
    kStopped,    ///< the agent ended in order
    kConflict,   ///< two living agents claim the name
    kLatched,    ///< it is there, and takes no commands until a user resumes it
};

/// The word on the bus: "unplugged", "silent", "agent-gone", "expired", "released", "stopped", "conflict",
/// "latched"; empty for kNone.
std::string_view to_text(StateReason reason);
/// kNone for a word that is not known: a later version may have more.
StateReason state_reason_from_text(std::string_view text);
/// For a person: "cable unplugged". Empty for an empty or unknown word.
std::string_view words_of(StateReason reason);

/// What `$state` alone says of the reason: that of the only program that publishes this word without a
/// description.
constexpr StateReason reason_of_word(BoardState state) {
    if (state == BoardState::kLost) return StateReason::kAgentGone;
    if (state == BoardState::kOffline) return StateReason::kStopped;
    return state == BoardState::kUpdating ? StateReason::kReleased : StateReason::kNone;
}

/// The state as an agent says it in a description.
struct SaidState {
    BoardState state = BoardState::kOnline;
    StateReason reason = StateReason::kNone;
    double age = 0;  ///< seconds since the board came into it, when this was published; 0 to
                     ///< kMaxStateAgeSeconds
    friend bool operator==(const SaidState&, const SaidState&) = default;
};
inline constexpr double kMaxStateAgeSeconds = 1e9;

/// `$state` and wills are published with this expiry, so that a program that starts later sees how old they
/// are.
inline constexpr std::uint32_t kStateExpirySeconds = 3'000'000'000;

}  // namespace asip::model
