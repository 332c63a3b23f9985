// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <vector>

#include "asip/expected.hpp"
#include "bench/load/board_kind.hpp"
#include "bench/load/fleet.hpp"
#include "bench/load/script.hpp"

namespace asip::load {

/// All options of the program, checked.
struct LoadOptions {
    FleetOptions fleet;
    BoardKind kind;
    std::vector<Step> steps;
    std::optional<Duration> time;  ///< nothing: until a signal
    bool watch = false;
    Duration settle = std::chrono::seconds(10);  ///< for the comparison with registries at the end
    // 0: none of them.
    double commands_per_second = 0;
    double queries_per_second = 0;
    std::size_t watchers = 0;
    bool json = false;  ///< the report is printed as JSON
};

/// From command line, environment and configuration file. The error is the exit status to end with; whatever
/// there was to print has been printed.
Expected<LoadOptions, int> read_options(int argc, const char* const* argv);

/// Boards that share a connection, at least, so that `boards` connections fit into `files` file descriptors
/// and `ports` port numbers of this machine.
std::size_t boards_per_connection(std::size_t boards, std::size_t files, std::size_t ports);

}  // namespace asip::load
