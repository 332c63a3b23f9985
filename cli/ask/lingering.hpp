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

/// Clears everything retained that is no longer needed, and prints it.
int clear_lingering(const LingeringOptions& options, Environment& environment);

}  // namespace asip::cli
