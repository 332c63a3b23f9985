// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cli/secure/folder.hpp"
#include "cli/secure/report.hpp"

/// What a broker needs beside its users. Each `ensure` keeps what is usable, and completes an interrupted
/// run.
namespace asip::cli {

/// Fails where this machine's clock cannot be right, since certificates depend on it.
Outcome<void> check_clock();

Outcome<void> ensure_authority(const SecureFolder& folder, SecureReport& report);
/// The broker's certificate is made anew where it does not fit its key, the authority or the hosts.
Outcome<void> ensure_certificate(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report);
/// In any case.
Outcome<void> write_certificate(const SecureFolder& folder, const SecuredBus& bus);
/// One that differs is kept and reported.
Outcome<void> ensure_configuration(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report);
/// Files of the system's broker that let in everybody: ours is moved away, others are the administrator's.
Outcome<void> close_open_listeners(const SecuredBus& bus, SecureReport& report);

/// Those that close_open_listeners() would move.
std::vector<std::filesystem::path> open_configurations(const SecuredBus& bus);
/// Takes back what ensure_configuration() and close_open_listeners() did.
Outcome<void> remove_configuration(const SecuredBus& bus, SecureReport& report);

}  // namespace asip::cli
