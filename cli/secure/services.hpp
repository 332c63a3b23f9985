// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "cli/commands/secure.hpp"
#include "cli/secure/folder.hpp"
#include "cli/secure/report.hpp"

/// The services of this machine, as the packages install them. Each looks for its credentials in one folder
/// (--credentials-dir): NAME.credentials, with the broker of this machine in place of its other addresses,
/// for root and the group of that folder.
namespace asip::cli {

using Names = std::vector<std::string>;

/// Where the services look for their credentials.
inline constexpr const char* kServiceCredentials = "/etc/asip/credentials";

/// Whether this run keeps the bus of this machine's broker for root, and the folder of the services is there.
bool keeps_services(const SecureOptions& options, const std::filesystem::path& folder, const SecuredBus& bus);

/// Boards whose agent runs on this machine: what they announce to the broker that `environment` names. Empty
/// where that one does not let us in.
Names boards_of_this_machine(const Environment& environment);

/// Adds users for the services that are installed, and for `boards`. Returns all of them; a board whose name
/// is in use is reported and left out. `bus` is changed and not yet saved.
Outcome<Names> ensure_services(const SecureFolder& folder, SecuredBus& bus, const Names& boards,
                               SecureReport& report);

/// Puts credentials of these users into the services' folder. Returns those whose file is not as it was.
Outcome<Names> give_to_services(const SecureFolder& folder, const SecuredBus& bus, const Names& names,
                                SecureReport& report);

/// The same for the users that have a file there; removes those of users who are gone.
Outcome<Names> refresh_services(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report);

/// Starts again what cannot see a change by itself: the broker where `broker`, and the services of these
/// users. Where no systemd runs, the commands are reported.
Outcome<void> restart_services(bool broker, const Names& changed, SecureReport& report);

/// The units of all services and agents that systemd runs, or tries to.
Names running_services();

/// `systemctl VERB UNITS`; where no systemd runs, that command is reported.
void order_units(const std::string& verb, const Names& units, SecureReport& report);

/// What asipctl does where the user says nothing else, for root: asks this bus as its administrator. Keeps a
/// choice that was made before.
void become_default(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report);

/// Takes back what give_to_services() and become_default() did.
Outcome<Names> take_from_services(const SecuredBus& bus, SecureReport& report);
void no_longer_default(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report);

}  // namespace asip::cli
