// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cli/environment.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct GetOptions {
    std::string target;  ///< BOARD[/SERVICE[/FIELD]]; empty: every board
    SelectorText selector{};
    bool raw = false;  ///< without units
    OutputOptions output{};
};

/// All values of boards (get_all.hpp), or one of a service, asked for or reported from now on; no retained
/// value. kExitNoAnswer: none came in time.
int run_get(const GetOptions& options, Environment& environment);

}  // namespace asip::cli
