// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct WaitOptions {
    std::string target;           ///< BOARD or BOARD/SERVICE
    std::string what = "online";  ///< a state of the board, or the name of an event
    OutputOptions output{};
};

/// `asipctl wait`: returns kExitOk once the board is in the state (at once when it is already), or once the
/// event was reported; kExitNoAnswer when it did not come within the context's timeout.
int run_wait(const WaitOptions& options, Environment& environment);

}  // namespace asip::cli
