// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>

#include "cli/ask/board_request.hpp"
#include "cli/output.hpp"

namespace asip::cli {

/// Sends and renews a command until the user ends it or `during` is over, then undoes it. Returns the exit
/// status.
int hold_command(Environment& environment, BusSession& session, const BoardCommand& command,
                 std::chrono::milliseconds hold, std::optional<std::chrono::milliseconds> during,
                 const OutputOptions& output);

}  // namespace asip::cli
