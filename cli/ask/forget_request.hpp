// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <set>
#include <string>
#include <vector>

#include "cli/ask/board_source.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/environment.hpp"

namespace asip::cli {

/// What a registry said to a request to forget boards.
struct AskedToForget {
    std::set<std::string> forgotten;
    std::set<std::string> refused;  ///< they are alive, or it did not answer; the user has been told why
    int status = program::kExitOk;  ///< kExitFailure, kExitNoAnswer or kExitBroker
};

/// Asks the registry, if there is one, to forget these boards; it may know some of them or none.
AskedToForget ask_to_forget(const Environment& environment, BusSession& session, BoardSource& source,
                            const std::vector<std::string>& boards);

}  // namespace asip::cli
