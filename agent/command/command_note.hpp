// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"
#include "asip/bus/request/reply.hpp"

namespace asip::agent {

/// The end of a command, of a stop, or of a hold that was not renewed.
struct CommandNote {
    // Views: they must live until note_command() returns.
    std::string_view what;     ///< "command", "stop" or "undone"
    std::string_view service;  ///< empty: raw lines, or the whole board
    std::string_view request;  ///< of a long one the beginning is noted
    std::string_view by;       ///< its sender
    const bus::Reply& outcome;
    bool proven = true;  ///< false: no answer was wanted, so that no proof was asked for
};
/// Notes a command and its sender on `servicebus/BOARD/$commands`, behind its answer, for a history. For a
/// sender without a name, "(unnamed)", only proven commands are noted.
void note_command(const Board& board, const CommandNote& note, Effects& out);

}  // namespace asip::agent
