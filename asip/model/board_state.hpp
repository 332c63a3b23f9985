// SPDX-License-Identifier: Apache-2.0
#pragma once
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

}  // namespace asip::model
