// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cli/commands/secure.hpp"
#include "cli/secure/folder.hpp"
#include "cli/secure/report.hpp"

/// What `asipctl secure` changes of a machine beyond its own folder: said before, and taken back.
namespace asip::cli {

/// What `init` would write and start again, a line each.
std::vector<std::string> plan_of(const SecureOptions& options, const std::filesystem::path& folder,
                                 const SecuredBus& bus);

/// Says what `init` will do where that changes the system, and asks. Fails where no user can be asked.
/// Nothing is asked for a bus of its own folder, and for one whose broker has its configuration already.
/// False: no.
Outcome<bool> agreed(const SecureOptions& options, const std::filesystem::path& folder, const SecuredBus& bus,
                     const Environment& environment);

/// `asipctl secure undo`: the machine as it was before `init`. The bus itself, in its folder, is kept.
Outcome<void> secure_undo(const SecureOptions& options, const Environment& environment, SecureReport& report);

}  // namespace asip::cli
