// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/reload.hpp"
#include "asip/text/file_text.hpp"

#include <csignal>
#include <cstdlib>

namespace asip::cli {
namespace {

constexpr const char* kSystemPidFile = "/run/mosquitto/mosquitto.pid";

int pid_in(const std::filesystem::path& file) {
    const auto text = text::file_text(file);
    return text ? std::atoi(text->c_str()) : 0;
}

bool is_mosquitto(int pid) {
    return pid > 0 && text::file_text("/proc/" + std::to_string(pid) + "/comm") == "mosquitto\n";
}

}  // namespace

bool is_system_broker(const std::filesystem::path& folder, const SecuredBus& bus) {
    return bus.configuration != folder / "mosquitto.conf";
}

Reload reload_broker(const SecureFolder& folder, const SecuredBus& bus, std::optional<std::size_t> pid) {
    const bool system = is_system_broker(folder.path(), bus);
    Reload made;
    made.pid = pid ? static_cast<int>(*pid) : pid_in(system ? kSystemPidFile : folder.pid_file());
    if (!is_mosquitto(made.pid)) {
        made.pid = 0;
        made.command = system ? "sudo systemctl reload mosquitto" : "kill -HUP PID_OF_MOSQUITTO";
        return made;
    }
    const bool sent = ::kill(made.pid, SIGHUP) == 0;
    made.result = sent ? Reload::Result::kReloaded : Reload::Result::kNotAllowed;
    made.command = system ? "sudo systemctl reload mosquitto" : "sudo kill -HUP " + std::to_string(made.pid);
    return made;
}

bool report_reload(const SecureFolder& folder, const SecuredBus& bus, std::optional<std::size_t> pid,
                   SecureReport& report) {
    const auto reload = reload_broker(folder, bus, pid);
    switch (reload.result) {
        case Reload::Result::kReloaded:
            report.did("reloaded", "the broker, process " + std::to_string(reload.pid));
            return true;
        case Reload::Result::kNotAllowed:
            report.next("let the broker read it; it is another user's", reload.command);
            return false;
        case Reload::Result::kNotRunning:
            report.next("no running broker was found here; if one runs, let it read it", reload.command);
    }
    return false;
}

}  // namespace asip::cli
