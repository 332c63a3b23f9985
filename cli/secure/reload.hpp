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
    std::string command;
};

/// The process is `pid`, else the pid file's. Only a process called mosquitto is sent a signal.
Reload reload_broker(const SecureFolder& folder, const SecuredBus& bus, std::optional<std::size_t> pid);

/// Not a configuration of its own.
bool is_system_broker(const std::filesystem::path& folder, const SecuredBus& bus);
/// True: the broker has read it. Reports that.
bool report_reload(const SecureFolder& folder, const SecuredBus& bus, std::optional<std::size_t> pid,
                   SecureReport& report);

}  // namespace asip::cli
