// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "agent/program/option_checks.hpp"
#include "asip/expected.hpp"

namespace asip::agent {

/// One board of the plan.
struct PlannedBoard {
    std::string key;   ///< its name, else its port; no two have the same
    std::string text;  ///< all that the file says of it: the same text, the same options
    AgentOptions options;
};

/// Which boards one process serves.
struct Plan {
    std::vector<PlannedBoard> boards;
    /// The configuration file whose sections `[board NAME]` they are. Empty: there is one board, that of the
    /// command line, and the process ends with it.
    std::string file;

    bool several() const { return !file.empty(); }
};

/// From command line, environment and configuration file. The error is the exit status to end with; whatever
/// there is to say has been printed.
Expected<Plan, int> read_plan(int argc, const char* const* argv);

/// The sections of the file `path`, each with what stands above them, the environment and the `arguments` of
/// the command line, which go before the file. Fails, with file and line, also for two boards that have one
/// name, one port, or one address for clients, and where there is no section.
Expected<Plan> plan_of_file(const std::string& path, const std::vector<std::string>& arguments);

}  // namespace asip::agent
