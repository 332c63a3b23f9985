// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/environment.hpp"
#include "cli/output.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {

/// By board, the newest document.
using AgentCounts = std::map<std::string, nlohmann::json>;

/// From `$stats`; what is no JSON object is passed over.
void take_counts(AgentCounts& counts, const std::string& board, const std::string& payload);

Table counts_table(const AgentCounts& counts);

/// Once each agent had the time to answer. kExitNoAnswer: none did.
int list_agents(const OutputOptions& output, Environment& environment);

}  // namespace asip::cli
