// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cli/context.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct ForgetOptions {
    std::string board;
    bool dry_run = false;
    bool force = false;  ///< also a board that seems alive
    OutputOptions output{};
};

/// `asipctl forget`: a board that is gone leaves every registry, and its retained topics are emptied.
/// kExitFailure when the board is unknown.
int run_forget(const ForgetOptions& options, Context& context);

}  // namespace asip::cli
