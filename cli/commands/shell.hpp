// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cli/environment.hpp"

namespace asip::cli {

struct ShellOptions {
    std::string board;
    std::string values = "on";  ///< show the newest values beside the line: on, off
};

/// `asipctl shell`: commands for one board, line by line. Edited on a terminal; else each line of standard
/// input is a command, and the status is that of the first that failed.
int run_shell(const ShellOptions& options, Environment& environment);

}  // namespace asip::cli
