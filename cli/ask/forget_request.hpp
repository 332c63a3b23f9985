// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <set>
#include <string>
#include <vector>

#include "cli/ask/board_source.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/environment.hpp"

namespace asip::cli {

/// A registry's answer.
struct AskedToForget {
    std::set<std::string> forgotten;
    std::set<std::string> refused;  ///< they are alive, or it did not answer; the user has been told why
    int status = program::kExitOk;  ///< kExitFailure, kExitNoAnswer or kExitBroker
};

/// Where there is a registry; it may know none of them.
AskedToForget ask_to_forget(const Environment& environment, BusSession& session, BoardSource& source,
                            const std::vector<std::string>& boards);

}  // namespace asip::cli
