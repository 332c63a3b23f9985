// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cli/secure/folder.hpp"
#include "cli/secure/report.hpp"

/// What a broker needs of `asipctl secure` beside its users. Each `ensure` keeps what is there and usable,
/// and completes what an interrupted run left.
namespace asip::cli {

/// Fails when this machine's clock cannot be right: certificates begin and end by it.
Outcome<void> check_clock();

/// Words with commas between.
std::string joined(const std::vector<std::string>& words);

Outcome<void> ensure_authority(const SecureFolder& folder, SecureReport& report);
/// The broker's certificate is made anew where it does not fit its key, the authority or the hosts.
Outcome<void> ensure_certificate(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report);
/// A new one in any case.
Outcome<void> write_certificate(const SecureFolder& folder, const SecuredBus& bus);
/// Mosquitto's own file. One that differs is kept and reported.
Outcome<void> ensure_configuration(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report);
/// Other files of the system broker's configuration that let in everybody: ours is moved out of the way,
/// others are the administrator's.
Outcome<void> close_open_listeners(const SecuredBus& bus, SecureReport& report);

/// Those that close_open_listeners() would move.
std::vector<std::filesystem::path> open_configurations(const SecuredBus& bus);
/// Takes back what ensure_configuration() and close_open_listeners() did to the system's broker.
Outcome<void> remove_configuration(const SecuredBus& bus, SecureReport& report);

}  // namespace asip::cli
