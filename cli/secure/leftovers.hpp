// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "cli/ask/retained.hpp"
#include "cli/secure/folder.hpp"
#include "cli/secure/report.hpp"

namespace asip::cli {

/// How this user connects, by the credentials that are kept in the folder.
Outcome<mqtt::Options> options_of(const SecureFolder& folder, const std::string& user);

/// Filters of all topics that are written by a user with this name, or for its board. Pure.
std::vector<std::string> filters_of(const bus::Topics& topics, const std::string& user);

/// What a user with this role may have left on topics without a user's name, in words: "3 commands". Empty:
/// nothing. Pure.
std::string unnamed_of(const bus::Topics& topics, const std::vector<Retained>& retained, Role role);

/// The broker reads which users are gone, and what they left in it is cleared; it has a reserve of memory for
/// that. Reports what to run where that is not possible now, and for messages on topics without a user's
/// name.
Outcome<void> reload_and_clear(const SecureFolder& folder, const SecuredBus& bus,
                               std::optional<std::size_t> pid, const std::vector<RoleOfUser>& gone,
                               const Environment& environment, SecureReport& report);

}  // namespace asip::cli
