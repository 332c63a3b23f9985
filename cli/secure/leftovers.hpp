// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "cli/ask/retained.hpp"
#include "cli/secure/folder.hpp"
#include "cli/secure/report.hpp"

namespace asip::cli {

/// By the credentials in the folder.
Outcome<mqtt::Options> options_of(const SecureFolder& folder, const std::string& user);

/// Filters of all topics of this user, or of its board. Pure.
std::vector<std::string> filters_of(const bus::Topics& topics, const std::string& user);

/// On topics without a user's name, in words: "3 commands". May be empty. Pure.
std::string unnamed_of(const bus::Topics& topics, const std::vector<Retained>& retained, Role role);

/// The broker reads which users are gone, and is cleared of what they left; it has a reserve of memory for
/// that. Reports what to run by hand, if anything.
Outcome<void> reload_and_clear(const SecureFolder& folder, const SecuredBus& bus,
                               std::optional<std::size_t> pid, const std::vector<RoleOfUser>& gone,
                               const Environment& environment, SecureReport& report);

}  // namespace asip::cli
