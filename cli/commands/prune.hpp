// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct PruneOptions {
    bool dry_run = false;
    std::vector<std::string> kinds;  ///< as prune_kind() names them; empty: all of them
    OutputOptions output{};
};

/// `asipctl prune`: clears everything retained that is no longer needed.
int run_prune(const PruneOptions& options, Environment& environment);

}  // namespace asip::cli
