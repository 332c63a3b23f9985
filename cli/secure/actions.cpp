// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/actions.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "asip/program/path.hpp"
#include "cli/find/broker_search.hpp"
#include "cli/secure/broker_files.hpp"
#include "cli/secure/leftovers.hpp"
#include "cli/secure/machine_names.hpp"
#include "cli/secure/reload.hpp"
#include "cli/secure/services.hpp"
#include "cli/secure/system.hpp"
#include "cli/secure/users.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

Outcome<void> check_hosts(const std::vector<std::string>& hosts) {
    for (const auto& host : hosts)
        if (!valid_host(host))
            return failure(program::kExitUsage, "--host " + host + " is neither a host name nor an address");
    return {};
}

std::string configuration_for(const SecureOptions& options, const fs::path& folder) {
    const fs::path system = options.mosquitto.empty() ? "/etc/mosquitto/conf.d" : options.mosquitto;
    const bool wanted = !options.mosquitto.empty() ||
                        (options.folder.empty() && ::geteuid() == 0 && fs::is_directory(system));
    return wanted ? fs::absolute(system / "asip-secured.conf").string()
                  : (folder / "mosquitto.conf").string();
}

Outcome<SecuredBus> ensure_bus(const SecureOptions& options, const Environment& environment,
                               const SecureFolder& folder) {
    if (folder.initialised()) {
        auto bus = folder.bus();
        if (bus && !options.hosts.empty() && bus->hosts != options.hosts) {
            return failure(program::kExitFailure,
                           "this bus exists, for " + listed(bus->hosts) +
                               "; another certificate: asipctl secure renew broker --host HOST");
        }
        return bus;
    }
    if (auto valid = check_hosts(options.hosts); !valid) return tl::unexpected(valid.error());
    if (environment.topics.root().find('%') != std::string::npos)
        return failure(program::kExitUsage, "access rules cannot have a topic root with %");
    SecuredBus bus;
    bus.hosts = options.hosts.empty() ? machine_names() : options.hosts;
    bus.port = static_cast<std::uint16_t>(options.port);
    bus.topic_root = environment.topics.root();
    bus.configuration = configuration_for(options, folder.path());
    return bus;
}

/// Debian has it where the shells of normal users do not look.
std::string broker_program() {
    if (program::is_in_path("mosquitto")) return "mosquitto";
    for (const auto* path : {"/usr/sbin/mosquitto", "/usr/local/sbin/mosquitto"})
        if (program::is_program(path)) return path;
    return "mosquitto";
}

std::string in_folder(const SecureOptions& options) {
    return options.folder.empty() ? "" : " --dir " + options.folder;
}

/// `taken`: the bus is new, and a program listens at its port.
void next_after_init(const SecureOptions& options, const SecureFolder& folder, const SecuredBus& bus,
                     bool taken, SecureReport& report) {
    if (keeps_services(options, folder.path(), bus)) {
        report.next("a board that is plugged in here later gets its credentials by",
                    "sudo asipctl secure add board NAME --here");
        report.next("give each person a file", "sudo asipctl secure add operator ann");
        return;
    }
    if (is_system_broker(folder.path(), bus))
        report.next("let the broker read it", "sudo systemctl restart mosquitto");
    else
        report.next("start the broker", broker_program() + " -c " + bus.configuration);
    if (taken) {
        report.next(
            "port " + std::to_string(bus.port) +
                " of this machine is in use: stop what listens there, or make another bus, on another port",
            "asipctl secure init --dir OTHER --port " +
                std::to_string(bus.port < 65535 ? bus.port + 1 : 8883));
    }
    report.next("give the agent of each board a file of its own",
                "asipctl secure" + in_folder(options) + " add board uno1");
    report.next("look at the bus as its administrator",
                "asipctl --credentials " + folder.credentials("admin").string() + " doctor");
}

/// How a program of this role is started, or an agent that is a service gets it; {} is the credentials file.
std::string use_of(Role role, bool as_services) {
    switch (role) {
        case Role::kBoard:
            if (as_services)
                return "sudo install -m 640 -g asip {} " + std::string(kServiceCredentials) +
                       "/ && sudo systemctl restart 'asip-agent@*'";
            return "asip-agent --serial /dev/ttyACM0 --credentials {}";
        case Role::kRegistry:
            return "asip-registry --credentials {}";
        case Role::kGateway:
            return "asip-gateway --credentials {}";
        default:
            return "asipctl --credentials {} list";
    }
}

/// What stands in a form of Home Assistant, which reads no credentials file.
void tell_home_assistant(const SecureFolder& folder, const SecuredBus& bus, const fs::path& file,
                         SecureReport& report) {
    report.next("in Home Assistant: Settings, Devices & services, Add integration (later: Reconfigure), MQTT",
                fmt::format("broker {}, port {}, user and password of {}", bus.hosts.front(), bus.port,
                            file.string()));
    report.next(
        "there, in Other settings (before 2026.8: in the next form, with Advanced options): Broker "
        "certificate validation: Custom, and as custom CA certificate file",
        folder.authority().string());
}

}  // namespace

fs::path secure_folder(const SecureOptions& options) {
    if (!options.folder.empty()) return fs::absolute(options.folder).lexically_normal();
    return ::geteuid() == 0 ? fs::path("/etc/asip/bus") : fs::absolute("asip-bus");
}

namespace {

Outcome<void> make_bus(const SecureFolder& folder, SecuredBus& bus, SecureReport& report) {
    if (auto done = ensure_authority(folder, report); !done) return done;
    if (auto done = ensure_certificate(folder, bus, report); !done) return done;
    if (auto done = ensure_user(folder, bus, "admin", Role::kAdmin, report); !done) return done;
    if (auto done = write_users(folder, bus); !done) return done;
    if (auto done = ensure_configuration(folder, bus, report); !done) return done;
    return is_system_broker(folder.path(), bus) ? close_open_listeners(bus, report) : Outcome<void>();
}

/// The bus, and the services of this machine with it. A run that ended before the broker was started with it
/// is known by a mark.
Outcome<void> make_bus_of_machine(const SecureOptions& options, const Environment& environment,
                                  const SecureFolder& folder, SecuredBus& bus, SecureReport& report) {
    const auto boards = boards_of_this_machine(environment);
    const bool interrupted = fs::exists(folder.unfinished());
    if (auto done = folder.write(folder.unfinished(), "", SecureFolder::Readers::kOwner); !done)
        return tl::unexpected(done.error());
    if (auto done = make_bus(folder, bus, report); !done) return done;
    const bool broker = interrupted || report.changed();
    const auto services = ensure_services(folder, bus, boards, report);
    if (!services) return tl::unexpected(services.error());
    if (auto done = write_users(folder, bus); !done) return done;
    auto changed = give_to_services(folder, bus, *services, report);
    if (!changed) return tl::unexpected(changed.error());
    if (!broker && report.changed()) report_reload(folder, bus, options.reload_pid, report);
    if (auto done = restart_services(broker, broker ? *services : *changed, report); !done) return done;
    become_default(folder, bus, report);
    std::error_code ignored;
    fs::remove(folder.unfinished(), ignored);
    return {};
}

/// What changed for services of this machine reaches them.
Outcome<void> tell_services(const SecureOptions& options, const SecureFolder& folder, const SecuredBus& bus,
                            SecureReport& report) {
    if (!keeps_services(options, folder.path(), bus)) return {};
    const auto changed = refresh_services(folder, bus, report);
    if (!changed) return tl::unexpected(changed.error());
    for (const auto& name : *changed)
        if (bus.find(name)->role == Role::kBoard)
            report.next("let the agent of " + name + " read it", "sudo systemctl restart 'asip-agent@*'");
    return restart_services(false, *changed, report);
}

}  // namespace

namespace {

Outcome<bool> agreed_to_init(const SecureOptions& options, const Environment& environment) {
    const auto path = secure_folder(options);
    if (fs::exists(path / "bus.json")) {
        const auto folder = SecureFolder::open(path);
        if (!folder) return tl::unexpected(folder.error());
        const auto bus = folder->bus();
        return bus ? agreed(options, path, *bus, environment) : tl::unexpected(bus.error());
    }
    SecuredBus bus;
    bus.port = static_cast<std::uint16_t>(options.port);
    bus.configuration = configuration_for(options, path);
    return agreed(options, path, bus, environment);
}

}  // namespace

Outcome<void> secure_init(const SecureOptions& options, const Environment& environment,
                          SecureReport& report) {
    if (auto right = check_clock(); !right) return right;
    const auto go_on = agreed_to_init(options, environment);
    if (!go_on) return tl::unexpected(go_on.error());
    if (!*go_on) return {};
    const auto folder = SecureFolder::create(secure_folder(options));
    if (!folder) return tl::unexpected(folder.error());
    const bool fresh = !folder->initialised();
    auto bus = ensure_bus(options, environment, *folder);
    if (!bus) return tl::unexpected(bus.error());
    const bool taken = fresh && !is_system_broker(folder->path(), *bus) && listens_here(bus->port);
    const auto done = keeps_services(options, folder->path(), *bus)
                          ? make_bus_of_machine(options, environment, *folder, *bus, report)
                          : make_bus(*folder, *bus, report);
    if (done) next_after_init(options, *folder, *bus, taken, report);
    return done;
}

Outcome<void> secure_add(const SecureOptions& options, const Environment& environment, SecureReport& report) {
    const auto role = parse_role(options.what);
    if (!role) {
        return failure(
            program::kExitUsage,
            "secure add needs a role: board, operator, viewer, registry, gateway, home-assistant or admin");
    }
    auto names = options.names;
    if (names.empty() &&
        (*role == Role::kRegistry || *role == Role::kGateway || *role == Role::kHomeAssistant))
        names.emplace_back(name_of(*role));
    if (names.empty()) return failure(program::kExitUsage, "secure add " + options.what + " needs a NAME");
    const auto folder = SecureFolder::open(secure_folder(options));
    if (!folder) return tl::unexpected(folder.error());
    auto bus = folder->bus();
    if (!bus) return tl::unexpected(bus.error());
    if (options.here && !keeps_services(options, folder->path(), *bus)) {
        return failure(program::kExitUsage,
                       "--here is for root on the broker's machine, with the services of the packages "
                       "(/etc/asip/credentials is made by asip-common)");
    }
    const auto boards = labelled_boards(options.selector, names, environment, *folder, *bus);
    if (!boards) return tl::unexpected(boards.error());
    for (const auto& name : names) {
        if (auto done = ensure_user(*folder, *bus, name, *role, report); !done) return done;
        if (*boards) give_boards(*bus, name, **boards, *options.selector, report);
    }
    if (auto done = write_users(*folder, *bus); !done) return done;
    report_reload(*folder, *bus, options.reload_pid, report);
    if (options.here) {
        const auto changed = give_to_services(*folder, *bus, names, report);
        return changed ? restart_services(false, *changed, report) : tl::unexpected(changed.error());
    }
    if (*boards) {
        std::string again = "asipctl secure" + in_folder(options) + " add operator";
        for (const auto& name : names)
            again += " " + name;
        report.next(
            "boards that get these labels later are not among them, and those that lose them stay: renew it "
            "by",
            again + " -l '" + *options.selector + "'");
    }
    for (const auto& name : names) {
        const auto file = folder->credentials(name);
        if (!fs::exists(file)) continue;
        if (*role == Role::kHomeAssistant)
            tell_home_assistant(*folder, *bus, file, report);
        else
            report.next(
                "copy " + file.string() + " to its machine, and there",
                fmt::format(fmt::runtime(use_of(*role, keeps_services(options, folder->path(), *bus))),
                            file.filename().string()));
    }
    return {};
}

Outcome<void> secure_revoke(const SecureOptions& options, const Environment& environment,
                            SecureReport& report) {
    if (options.what.empty()) return failure(program::kExitUsage, "secure revoke needs a NAME");
    const auto folder = SecureFolder::open(secure_folder(options));
    if (!folder) return tl::unexpected(folder.error());
    auto bus = folder->bus();
    if (!bus) return tl::unexpected(bus.error());
    auto names = options.names;
    names.insert(names.begin(), options.what);
    for (const auto& name : names) {
        if (auto known = check_known(*bus, name); !known) {
            // It may have been taken out by a run that was interrupted before the broker heard of it, or that
            // could not clear what the user left.
            if (auto done = write_users(*folder, *bus); !done) return done;
            const auto done = reload_and_clear(*folder, *bus, options.reload_pid, {{name, Role::kViewer}},
                                               environment, report);
            return done ? known : done;
        }
    }
    std::vector<RoleOfUser> gone;
    for (const auto& name : names) {
        gone.push_back({name, bus->find(name) != nullptr ? bus->find(name)->role : Role::kViewer});
        if (auto done = remove_user(*folder, *bus, name, report); !done) return done;
    }
    if (auto done = write_users(*folder, *bus); !done) return done;
    if (auto done = reload_and_clear(*folder, *bus, options.reload_pid, gone, environment, report); !done)
        return done;
    return tell_services(options, *folder, *bus, report);
}

Outcome<void> secure_renew(const SecureOptions& options, SecureReport& report) {
    if (options.what.empty()) return failure(program::kExitUsage, "secure renew needs a NAME, or broker");
    if (auto valid = check_hosts(options.hosts); !valid) return valid;
    const auto folder = SecureFolder::open(secure_folder(options));
    if (!folder) return tl::unexpected(folder.error());
    auto bus = folder->bus();
    if (!bus) return tl::unexpected(bus.error());
    if (options.what == "broker") {
        if (auto right = check_clock(); !right) return right;
        if (!options.hosts.empty()) bus->hosts = options.hosts;
        // First, so that init makes the certificate for them if this run ends here.
        if (auto done = folder->save(*bus); !done) return done;
        if (auto done = write_certificate(*folder, *bus); !done) return done;
        report.did("changed", "certificate of the broker for " + listed(bus->hosts), folder->certificate());
        if (auto done = refresh_credentials(*folder, *bus, report); !done) return done;
    } else if (auto done = renew_user(*folder, *bus, options.what, report); !done) {
        return done;
    }
    if (auto done = write_users(*folder, *bus); !done) return done;
    report_reload(*folder, *bus, options.reload_pid, report);
    const auto* user = options.what == "broker" ? nullptr : bus->find(options.what);
    if (user != nullptr && user->role == Role::kHomeAssistant)
        tell_home_assistant(*folder, *bus, folder->credentials(options.what), report);
    else if (options.what != "broker")
        report.next("copy " + folder->credentials(options.what).string() +
                    " to its machine; the file from before counts no more");
    return tell_services(options, *folder, *bus, report);
}

}  // namespace asip::cli
