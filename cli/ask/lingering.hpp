// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct LingeringOptions {
    bool dry_run = false;
    std::vector<std::string> kinds;  ///< as clear_lingering() prints them; empty: all
    OutputOptions output{};
};

/// Prints what it clears.
int clear_lingering(const LingeringOptions& options, Environment& environment);

}  // namespace asip::cli
