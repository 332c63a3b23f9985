// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "asip/program/process_usage.hpp"
#include "bench/load/commander.hpp"
#include "bench/load/fleet.hpp"
#include "bench/load/questions.hpp"
#include "bench/load/watch.hpp"
#include "bench/load/watchers.hpp"

namespace asip::load {

/// What a run did and saw. What was not asked for by an option is not there.
struct Report {
    std::size_t boards = 0;
    std::size_t connections = 0;
    double seconds = 0;         ///< that the run took, without goodbyes
    std::size_t present = 0;    ///< at the end
    std::size_t announced = 0;  ///< of those, the broker has the description of so many
    Tally tally;
    std::optional<CommandTally> commands;
    std::optional<QueryTally> queries;
    std::optional<WatchersTally> watchers;
    std::map<std::string, Watched> registries;
    bool watched = false;
    program::ProcessUsage usage;

    /// Boards were announced, each that is present is, no name was another's, each registry agrees, and
    /// questions have answers of which none is wrong.
    bool good() const;
};

/// For programs (`--json`): times in milliseconds, as median, 99 % and longest.
nlohmann::json to_json(const Report& report);
/// A table for a person, with a line end behind each row.
std::string to_table(const Report& report);

}  // namespace asip::load
