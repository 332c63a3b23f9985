// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>

#include "asip/model/description.hpp"
#include "asip/session/identity.hpp"
#include "asip/session/service_table.hpp"

namespace asip::agent {

/// What is known of a board besides its own words.
struct BoardFacts {
    model::LinkInfo link;
    model::AgentInfo agent;
    std::map<char, int> counts;   ///< elements of a service, as seen in its events
    std::map<char, int> periods;  ///< of auto-events, ms
    model::Labels labels;
    std::string labels_fault{};  ///< model::Description::labels_fault
    std::optional<model::OnDemandInfo> on_demand{};
};

/// Everything of the description but board name, session, seq and lease, which whoever announces it fills in.
model::Description describe(const session::Identity& board, const session::ServiceTable& services,
                            const model::ModelSet& models, const BoardFacts& facts);

/// The name for a board that has none and was given none: from the port or address it is at.
std::string name_from_link(const model::LinkInfo& link);

}  // namespace asip::agent
