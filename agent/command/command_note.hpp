// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "agent/bridge/effects.hpp"
#include "asip/bus/reply.hpp"
#include "asip/bus/topics.hpp"

namespace asip::agent {

/// What became of a command, or of a held one.
struct CommandNote {
    std::string_view what;     ///< "command", "stop" or "undone"
    std::string_view service;  ///< empty: raw lines, or the whole board
    std::string_view request;  ///< of a long one the beginning is noted
    std::string_view by;       ///< who sent it
    const bus::Reply& outcome;
    bool proven = true;  ///< false: nobody wanted an answer, so no proof was asked for
};
/// Notes on `servicebus/BOARD/$commands` who commanded what, behind its answer, for a history. Nothing where
/// the sender is not known.
void note_command(const bus::Topics& topics, std::string_view board, const CommandNote& note, Effects& out);

}  // namespace asip::agent
