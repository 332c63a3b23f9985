// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct ForgetOptions {
    std::vector<std::string> boards;  ///< names, and patterns of them
    bool leftovers = false;           ///< in place of boards
    std::vector<std::string> kinds;   ///< of leftovers
    bool dry_run = false;
    bool force = false;  ///< also boards that seem alive
    OutputOptions output{};
};

/// `asipctl forget`: boards that are gone leave every registry, and their retained topics are emptied.
/// kExitFailure when one is unknown or alive, or when a pattern means none.
int run_forget(const ForgetOptions& options, Environment& environment);

}  // namespace asip::cli
