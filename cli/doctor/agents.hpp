// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/environment.hpp"
#include "cli/output.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {

/// What agents say that they counted, by board: the newest document of each.
using AgentCounts = std::map<std::string, nlohmann::json>;

/// Takes a message on a board's `$stats`. Anybody may have written it; what is no JSON object is passed over.
void take_counts(AgentCounts& counts, const std::string& board, const std::string& payload);

Table counts_table(const AgentCounts& counts);

/// Prints what agents counted since they started, once each had the time to say it. kExitNoAnswer: none did.
int list_agents(const OutputOptions& output, Environment& environment);

}  // namespace asip::cli
