// SPDX-License-Identifier: Apache-2.0
#include "cli/doctor/machine.hpp"
#include "asip/text/file_text.hpp"

#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> entries(const fs::path& folder) {
    std::vector<fs::path> result;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
        result.push_back(it->path());
    std::sort(result.begin(), result.end());
    return result;
}

std::string group_of(const fs::path& file) {
    struct stat status{};
    if (::stat(file.c_str(), &status) != 0) return {};
    const auto* group = ::getgrgid(status.st_gid);
    return group == nullptr ? std::to_string(status.st_gid) : group->gr_name;
}

bool is_board_port(const std::string& name) {
    return name.starts_with("ttyACM") || name.starts_with("ttyUSB");
}

bool runs(const fs::path& proc, const std::string& program) {
    for (const auto& entry : entries(proc)) {
        const auto name = entry.filename().string();
        if (name.empty() || std::isdigit(static_cast<unsigned char>(name.front())) == 0) continue;
        // The kernel keeps 15 characters.
        if (text::file_text(entry / "comm") == program.substr(0, 15) + "\n") return true;
    }
    return false;
}

bool has_rule(const fs::path& folder) {
    const auto rules = entries(folder);
    return std::any_of(rules.begin(), rules.end(), [](const fs::path& rule) {
        return rule.filename().string().find("asip") != std::string::npos &&
               text::file_text(rule).value_or("").find("ID_MM_DEVICE_IGNORE") != std::string::npos;
    });
}

}  // namespace

Machine look_at_machine(const fs::path& root) {
    Machine result;
    for (const auto& port : entries(root / "dev")) {
        if (!is_board_port(port.filename().string())) continue;
        result.ports.push_back({port.string(), ::access(port.c_str(), R_OK | W_OK) == 0, group_of(port)});
    }
    result.modem_manager = runs(root / "proc", "ModemManager");
    result.brltty = runs(root / "proc", "brltty");
    for (const auto* folder : {"usr/lib/udev/rules.d", "lib/udev/rules.d"})
        for (const auto& rule : entries(root / folder)) {
            // A rule of the administrator with the same name, empty or a link to /dev/null, takes its place.
            std::error_code error;
            result.brltty =
                result.brltty ||
                (rule.filename().string().find("brltty") != std::string::npos &&
                 !fs::exists(fs::symlink_status(root / "etc/udev/rules.d" / rule.filename(), error)));
        }
    for (const auto* folder :
         {"etc/udev/rules.d", "usr/lib/udev/rules.d", "lib/udev/rules.d", "run/udev/rules.d"}) {
        result.udev_rule = result.udev_rule || has_rule(root / folder);
    }
    for (const auto* folder : {"etc/systemd/system", "usr/lib/systemd/system", "lib/systemd/system"}) {
        std::error_code error;
        result.starts_agents = result.starts_agents ||
                               (result.udev_rule && fs::exists(root / folder / "asip-agent@.service", error));
    }
    return result;
}

Findings check_machine(const Machine& machine) {
    Findings result;
    for (const auto& port : machine.ports) {
        if (port.may_use) {
            result.push_back(fine("port " + port.path + " may be used"));
            continue;
        }
        const bool group = !port.group.empty() && port.group != "root";
        result.push_back(
            problem("no right on the port " + port.path,
                    group ? "sudo usermod -aG " + port.group + " $USER, then log in again"
                          : "install the udev rule: packaging/udev/70-asip.rules to /etc/udev/rules.d/"));
    }
    if (machine.brltty) {
        result.push_back(
            note("brltty is installed here: it takes serial converters that look like a Braille display "
                 "(CH340, CP210x, FTDI), so that their port vanishes or is in use",
                 "without a Braille display: sudo apt remove brltty; with one: sudo ln -s /dev/null "
                 "/etc/udev/rules.d/85-brltty.rules (the name as in /usr/lib/udev/rules.d)"));
    }
    if (machine.modem_manager && !machine.udev_rule) {
        result.push_back(
            problem("ModemManager runs here and sends AT commands to each board that is plugged in",
                    "install packaging/udev/70-asip.rules to /etc/udev/rules.d/, then: sudo udevadm control "
                    "--reload"));
    }
    return result;
}

}  // namespace asip::cli
