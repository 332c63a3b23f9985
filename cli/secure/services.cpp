// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/services.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <sstream>

#include "asip/mqtt/options.hpp"
#include "asip/program/credentials.hpp"
#include "asip/program/kept_file.hpp"
#include "asip/program/options.hpp"
#include "asip/text/file_text.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/find/user_file.hpp"
#include "cli/flash/programmer.hpp"
#include "cli/secure/reload.hpp"
#include "cli/secure/users.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = kServiceCredentials;
constexpr std::chrono::milliseconds kLook{2000};
/// What stands on the bus may be anybody's word, as long as it is open.
constexpr std::size_t kMaxBoards = 256;

fs::path file_of(const std::string& user) {
    return fs::path(kFolder) / (user + ".credentials");
}

bool is_unit(const std::string& name) {
    for (const char* folder : {"/etc/systemd/system/", "/lib/systemd/system/", "/usr/lib/systemd/system/"})
        if (fs::exists(folder + name + ".service")) return true;
    return false;
}

Failure failed_to(const std::string& what, const fs::path& path) {
    return {program::kExitFailure, "cannot " + what + " " + path.string() + ": " + std::strerror(errno)};
}

/// For root and the group of the folder. Whole or not at all.
Outcome<bool> write_for_group(const fs::path& file, const std::string& text) {
    struct stat folder{}, present{};
    if (::stat(kFolder, &folder) != 0) return tl::unexpected(failed_to("look at", kFolder));
    const bool kept = ::lstat(file.c_str(), &present) == 0 && S_ISREG(present.st_mode) &&
                      (present.st_mode & 0777) == 0640 && present.st_gid == folder.st_gid;
    if (kept && text::file_text(file) == text) return false;
    if (!program::replace_file(file, text, {0640, 0, folder.st_gid}))
        return tl::unexpected(failed_to("write", file));
    return true;
}

/// For programs on the broker's machine, whatever the network calls it.
SecuredBus from_here(SecuredBus bus) {
    bus.hosts = {"localhost"};
    return bus;
}

/// The lines of root's own asipctl.
std::string as_administrator(const SecureFolder& folder, const SecuredBus& bus) {
    return "# Made by asipctl secure.\nbroker = " +
           mqtt::BrokerAddress{"localhost", bus.port, true}.describe() +
           "\ncredentials = " + folder.credentials("admin").string() + "\n";
}

Outcome<int> run_and_wait(const Names& call) {
    auto program = RunningProgram::start(call);
    if (!program) return failure(program::kExitFailure, program.error());
    return program->wait();
}

Outcome<void> restart(const std::string& unit, SecureReport& report) {
    if (const auto status = run_and_wait({"systemctl", "restart", unit}); !status || *status != 0)
        return failure(program::kExitFailure,
                       unit + " did not start: journalctl -u " + unit + "; then repeat this");
    report.did("restarted", unit);
    return {};
}

}  // namespace

bool keeps_services(const SecureOptions& options, const fs::path& folder, const SecuredBus& bus) {
    return options.folder.empty() && ::geteuid() == 0 && is_system_broker(folder, bus) &&
           fs::is_directory(kFolder);
}

Names boards_of_this_machine(const Environment& environment) {
    Environment own = environment;
    own.from_bus = true;
    own.timeout = kLook;
    own.mqtt.connect_timeout = kLook;
    BusSession session(own);
    BoardSource source(own, session);
    if (!session.connect()) return {};
    source.read_bus(true);
    Names here;
    for (const auto& name : source.bus().names()) {
        const auto* description = source.bus().description(name);
        if (description != nullptr && description->agent.host == program::host_name() &&
            here.size() < kMaxBoards)
            here.push_back(name);
    }
    return here;
}

Outcome<Names> ensure_services(const SecureFolder& folder, SecuredBus& bus, const Names& boards,
                               SecureReport& report) {
    Names all;
    for (const auto role : {Role::kRegistry, Role::kGateway}) {
        const std::string name(name_of(role));
        if (!is_unit("asip-" + name)) continue;
        if (auto done = ensure_user(folder, bus, name, role, report); !done)
            return tl::unexpected(done.error());
        all.push_back(name);
    }
    for (const auto& name : boards) {
        if (auto done = ensure_user(folder, bus, name, Role::kBoard, report); !done) {
            report.did("warning", "board " + name + " gets no credentials: " + done.error().text);
            continue;
        }
        all.push_back(name);
    }
    return all;
}

Outcome<Names> give_to_services(const SecureFolder& folder, const SecuredBus& bus, const Names& names,
                                SecureReport& report) {
    const auto authority = text::file_text(folder.authority());
    if (!authority) return tl::unexpected(failed_to("read", folder.authority()));
    Names changed;
    for (const auto& name : names) {
        const auto* user = bus.find(name);
        const auto own = program::read_credentials(folder.credentials(name));
        if (user == nullptr || !own) {
            if (!fs::exists(file_of(name)))
                report.did("warning", "no credentials of " + name +
                                          " to give to its service: asipctl secure renew " + name);
            continue;
        }
        const auto text = credentials_text(from_here(bus), *user, own->password, *authority);
        const auto written = write_for_group(file_of(name), text);
        if (!written) return tl::unexpected(written.error());
        if (!*written) continue;
        report.did("gave", "credentials of " + name + " to its service on this machine", file_of(name));
        changed.push_back(name);
    }
    return changed;
}

Outcome<Names> refresh_services(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report) {
    Names present;
    std::error_code error;
    for (fs::directory_iterator it(kFolder, error), end; !error && it != end; it.increment(error))
        if (it->path().extension() == ".credentials") present.push_back(it->path().stem().string());
    std::sort(present.begin(), present.end());
    for (const auto& name : present) {
        if (bus.find(name) != nullptr) continue;
        fs::remove(file_of(name), error);
        if (error)
            return failure(program::kExitFailure,
                           "cannot remove " + file_of(name).string() + ": " + error.message());
        report.did("removed", "credentials of " + name + " from its service on this machine", file_of(name));
    }
    std::erase_if(present, [&](const auto& name) { return bus.find(name) == nullptr; });
    return give_to_services(folder, bus, present, report);
}

Outcome<void> restart_services(bool broker, const Names& changed, SecureReport& report) {
    Names units;
    if (broker) units.emplace_back("mosquitto");
    for (const auto& name : changed) {
        const bool service = name == name_of(Role::kRegistry) || name == name_of(Role::kGateway);
        if (service && is_unit("asip-" + name)) units.push_back("asip-" + name);
    }
    for (const auto& unit : units) {
        if (!fs::is_directory("/run/systemd/system")) {
            report.next("let it read the change", "systemctl restart " + unit);
            continue;
        }
        // What an administrator has switched off stays off.
        const auto wanted = run_and_wait({"systemctl", "is-enabled", "--quiet", unit});
        if (unit != "mosquitto" && wanted && *wanted != 0) continue;
        if (auto done = restart(unit, report); !done) return done;
    }
    return {};
}

Names running_services() {
    Names units;
    auto* list = ::popen(
        "systemctl list-units --plain --no-legend --state=active,activating,deactivating,reloading "
        "asip-registry.service asip-gateway.service 'asip-agent@*.service' asip-boards.service "
        "asip-cables.service 2>/dev/null",
        "re");
    if (list == nullptr) return units;
    std::array<char, 4096> line{};
    while (std::fgets(line.data(), line.size(), list) != nullptr)
        if (std::string unit; std::istringstream(line.data()) >> unit) units.push_back(unit);
    ::pclose(list);
    return units;
}

void order_units(const std::string& verb, const Names& units, SecureReport& report) {
    Names call{"systemctl", verb};
    call.insert(call.end(), units.begin(), units.end());
    if (fs::is_directory("/run/systemd/system"))
        run_and_wait(call);
    else
        report.next("then", "systemctl " + verb + " " + listed(units));
}

void become_default(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report) {
    const auto home = program::environment_variable("HOME").value_or("");
    struct stat status{};
    // After `su` the home may be that of another user, who alone writes it.
    if (home.empty() || ::stat(home.c_str(), &status) != 0 || status.st_uid != ::geteuid()) return;
    const auto file = user_file(program::environment_variable);
    std::error_code error;
    if (!file || fs::exists(*file, error) || !program::keep_file(*file, as_administrator(folder, bus)))
        return;
    report.did("made", "configuration by which asipctl, by root, asks this bus as its administrator", *file);
}

Outcome<Names> take_from_services(const SecuredBus& bus, SecureReport& report) {
    Names taken;
    for (const auto& user : bus.users) {
        std::error_code error;
        if (!fs::remove(file_of(user.name), error) && !error) continue;
        if (error)
            return failure(program::kExitFailure,
                           "cannot remove " + file_of(user.name).string() + ": " + error.message());
        report.did("removed", "credentials of " + user.name + " from its service on this machine",
                   file_of(user.name));
        taken.push_back(user.name);
    }
    return taken;
}

void no_longer_default(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report) {
    const auto file = user_file(program::environment_variable);
    if (!file || text::file_text(*file).value_or("") != as_administrator(folder, bus)) return;
    if (program::drop_file(*file)) report.did("removed", "configuration of root's asipctl", *file);
}

}  // namespace asip::cli
