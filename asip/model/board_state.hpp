// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

namespace asip::model {

/// As the retained `$state` holds it.
enum class BoardState {
    kOnline,
    kOffline,   ///< its agent ended in order
    kLost,      ///< the broker published the will of its agent, or its lease ran out
    kSleeping,  ///< alive, but does not answer for a while
    kUpdating,  ///< alive, and being given new firmware
};

std::string_view to_text(BoardState state);
/// Nothing: it is none of these words.
std::optional<BoardState> board_state_from_text(std::string_view text);

/// As long as its lease runs.
constexpr bool is_there(BoardState state) {
    return state != BoardState::kOffline && state != BoardState::kLost;
}
/// The opposite, for a word that a view shows: an unknown word is no board that is gone.
bool is_gone(std::string_view word);
/// The board is there, and no other program has its port.
bool takes_commands(std::string_view word);

/// Part of the state: each view shows it.
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

/// Empty for kNone.
std::string_view to_text(StateReason reason);
/// kNone for an unknown word: a later version may have more.
StateReason state_reason_from_text(std::string_view text);
/// For a person: "cable unplugged"; may be empty.
std::string_view words_of(StateReason reason);

/// What `$state` alone says of the reason: only one program publishes each word without a description.
constexpr StateReason reason_of_word(BoardState state) {
    if (state == BoardState::kLost) return StateReason::kAgentGone;
    if (state == BoardState::kOffline) return StateReason::kStopped;
    return state == BoardState::kUpdating ? StateReason::kReleased : StateReason::kNone;
}

/// As an agent says it in a description.
struct SaidState {
    BoardState state = BoardState::kOnline;
    StateReason reason = StateReason::kNone;
    double age = 0;  ///< seconds since the board came into it, when this was published; 0 to
                     ///< kMaxStateAgeSeconds
    friend bool operator==(const SaidState&, const SaidState&) = default;
};
inline constexpr double kMaxStateAgeSeconds = 1e9;

/// The expiry of `$state` and wills: it shows how old they are.
inline constexpr std::uint32_t kStateExpirySeconds = 3'000'000'000;

}  // namespace asip::model
