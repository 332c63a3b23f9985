// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cli/commands/secure.hpp"
#include "cli/secure/report.hpp"

/// The actions of `asipctl secure`: each completes what is missing and leaves what is there.
namespace asip::cli {

/// `--dir`, else /etc/asip/bus for root and asip-bus in the current folder for others.
std::filesystem::path secure_folder(const SecureOptions& options);

Outcome<void> secure_init(const SecureOptions& options, const Environment& environment, SecureReport& report);
Outcome<void> secure_add(const SecureOptions& options, const Environment& environment, SecureReport& report);
Outcome<void> secure_revoke(const SecureOptions& options, const Environment& environment,
                            SecureReport& report);
Outcome<void> secure_renew(const SecureOptions& options, SecureReport& report);

}  // namespace asip::cli
