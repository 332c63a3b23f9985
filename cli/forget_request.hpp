// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cli/board_source.hpp"
#include "cli/bus_session.hpp"
#include "cli/context.hpp"

namespace asip::cli {

enum class Forgotten {
    kYes,
    kUnknownBoard,  ///< the registry knows no such board
    kNoRegistry
};

/// Asks the registry to forget a board. Fails with kExitNoAnswer when it does not answer, and with
/// kExitFailure when it refuses: the board is alive.
Outcome<Forgotten> ask_to_forget(const Context& context, BusSession& session, BoardSource& source,
                                 const std::string& board);

}  // namespace asip::cli
