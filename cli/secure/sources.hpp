// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "cli/ask/bus_session.hpp"
#include "cli/commands/secure.hpp"
#include "cli/secure/bus_file.hpp"
#include "cli/secure/report.hpp"
#include "cli/secure/trials.hpp"

/// Links (docs/links.md) on a secured bus: which boards the agent of another one may hear, and what a user
/// leaves at the agents.
namespace asip::cli {

/// Lets the agent of the board `what` hear those that `names` has (`link`), or not any more (`unlink`).
Outcome<void> secure_link(const SecureOptions& options, SecureReport& report);

/// The access rules that follow.
std::string source_rules(const SecuredBus& bus);
/// Nothing that a board's agent hears in these is of any account.
std::vector<Trial> source_trials(const SecuredBus& bus, const std::string& board,
                                 const std::string& stranger);

/// The agents remove the links of a user that is gone; those that do not answer are named.
void clear_links(const Environment& admin, BusSession& session, const std::string& user,
                 const std::string& folder, SecureReport& report);

}  // namespace asip::cli
