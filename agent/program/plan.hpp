// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "agent/program/option_checks.hpp"
#include "asip/expected.hpp"

namespace asip::agent {

struct PlannedBoard {
    std::string key;   ///< its name, else its port; no two have the same
    std::string text;  ///< all that the file says of it: the same text, the same options
    AgentOptions options;
};

/// Boards that browsers lend.
struct Lending {
    std::string folder;    ///< see Cables
    AgentOptions options;  ///< of each, but for its port
};

/// Which boards one process serves.
struct Plan {
    std::vector<PlannedBoard> boards;
    std::optional<Lending> lending;
    /// The configuration file with the sections `[board NAME]`. Empty: there is one board, and the process
    /// ends with it.
    std::string file;

    bool several() const { return !file.empty() || lending; }
};

/// From command line, environment and configuration file. The error is the exit status; all has been printed.
Expected<Plan, int> read_plan(int argc, const char* const* argv);

/// The sections of the file, each with what stands above them, the environment and `arguments`, which go
/// first. Fails with file and line, also where two boards share a name, a port or an address, and where there
/// is no section.
Expected<Plan> plan_of_file(const std::string& path, const std::vector<std::string>& arguments);

}  // namespace asip::agent
