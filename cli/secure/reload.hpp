// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "cli/secure/folder.hpp"
#include "cli/secure/report.hpp"

namespace asip::cli {

struct Reload {
    enum class Result {
        kReloaded,    ///< the broker was sent SIGHUP: it reads passwords and rules again, keeps connections
        kNotRunning,  ///< nothing known of a running broker
        kNotAllowed   ///< it belongs to another user
    };
    Result result = Result::kNotRunning;
    int pid = 0;
    /// What to run by hand.
    std::string command;
};

/// Makes the broker that reads this folder's files read them again: the process `pid`, else the one of the
/// pid file that its configuration names. Only a process called mosquitto is sent a signal.
Reload reload_broker(const SecureFolder& folder, const SecuredBus& bus, std::optional<std::size_t> pid);

/// Whether the configuration is a file of the system's broker, not one of its own.
bool is_system_broker(const std::filesystem::path& folder, const SecuredBus& bus);
/// The same; whether the broker has read it, is reported.
bool report_reload(const SecureFolder& folder, const SecuredBus& bus, std::optional<std::size_t> pid,
                   SecureReport& report);

}  // namespace asip::cli
