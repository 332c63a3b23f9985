#pragma once
#include <string>
#include <vector>

#include "cli/context.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct ForgetOptions {
    std::string board;
    bool dry_run = false;
    bool force = false;  ///< also one that seems alive
    Output output = Output::kText;
};

/// `asipctl forget`: a board that is gone leaves every registry, and its retained topics are emptied.
int run_forget(const ForgetOptions& options, Context& context);

struct PruneOptions {
    bool dry_run = false;
    std::vector<std::string> kinds;  ///< boards, commands, orphans, names, registries; empty: all of them
    Output output = Output::kTable;
};

/// `asipctl prune`: the same for everything that lingers.
int run_prune(const PruneOptions& options, Context& context);

}  // namespace asip::cli
