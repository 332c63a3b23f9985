#pragma once
#include <optional>
#include <string_view>

namespace asip::model {

/// What `$state` says of a board.
enum class BoardState {
    Online,
    Offline,  // said goodbye
    Lost,     // its will spoke, or its lease ran out
    Sleeping,
    Updating,
};

/// "online", "offline", "lost", "sleeping", "updating".
std::string_view to_text(BoardState state);
/// The exact word; nothing otherwise.
std::optional<BoardState> board_state_from_text(std::string_view text);

}  // namespace asip::model
