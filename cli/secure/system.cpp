// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/system.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <ostream>

#include "cli/secure/actions.hpp"
#include "cli/secure/broker_files.hpp"
#include "cli/secure/reload.hpp"
#include "cli/secure/services.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

void tell(const std::vector<std::string>& plan, std::ostream& out) {
    out << "asipctl secure init will\n";
    for (const auto& line : plan)
        out << "  " << for_terminal(line) << '\n';
    out << std::flush;
}

}  // namespace

std::vector<std::string> plan_of(const SecureOptions& options, const fs::path& folder,
                                 const SecuredBus& bus) {
    std::vector<std::string> plan{"keep authority, keys and passwords in " + folder.string()};
    plan.push_back(fmt::format("write {}: port {}, known users only", bus.configuration, bus.port));
    if (!is_system_broker(folder, bus)) return plan;
    for (const auto& file : open_configurations(bus))
        plan.push_back("move " + file.string() + ", which lets in everybody, to " + file.string() + ".open");
    if (!keeps_services(options, folder, bus)) return plan;
    plan.push_back("write credentials for the services and boards of this machine to " +
                   std::string(kServiceCredentials));
    plan.emplace_back("restart mosquitto, and asip-registry and asip-gateway where they are enabled");
    plan.emplace_back("make the bus the one that asipctl asks, for root");
    return plan;
}

Outcome<bool> agreed(const SecureOptions& options, const fs::path& folder, const SecuredBus& bus,
                     const Environment& environment) {
    const auto plan = plan_of(options, folder, bus);
    if (options.dry_run) {
        tell(plan, environment.out);
        return false;
    }
    if (options.yes || !is_system_broker(folder, bus) || fs::exists(bus.configuration)) return true;
    if (!environment.terminal() || ::isatty(STDIN_FILENO) == 0) {
        tell(plan, environment.err);
        return failure(program::kExitUsage,
                       "This changes the system, and there is no terminal to ask at. --yes: do it; "
                       "--dry-run: only say it; --dir DIR: a bus in a folder of its own");
    }
    tell(plan, environment.out);
    environment.out << "`asipctl secure undo` takes it back. Continue? [y/N] " << std::flush;
    std::string answer;
    std::getline(environment.in, answer);
    return answer == "y" || answer == "Y" || answer == "yes";
}

Outcome<void> secure_undo(const SecureOptions& options, const Environment& environment,
                          SecureReport& report) {
    const auto folder = SecureFolder::open(secure_folder(options));
    if (!folder) return tl::unexpected(folder.error());
    const auto bus = folder->bus();
    if (!bus) return tl::unexpected(bus.error());
    if (!is_system_broker(folder->path(), *bus)) {
        return failure(program::kExitFailure,
                       "nothing was changed outside of " + folder->path().string() +
                           ": stop its broker, and remove that folder to give the bus up");
    }
    if (options.dry_run) {
        environment.out << "asipctl secure undo will remove " << bus->configuration
                        << ", and open what init closed"
                        << (keeps_services(options, folder->path(), *bus)
                                ? "; take credentials from the services of this machine, and restart them\n"
                                : "\n")
                        << std::flush;
        return {};
    }
    if (auto done = remove_configuration(*bus, report); !done) return done;
    if (keeps_services(options, folder->path(), *bus)) {
        const auto changed = take_from_services(*bus, report);
        if (!changed) return tl::unexpected(changed.error());
        no_longer_default(*folder, *bus, report);
        if (auto done = restart_services(true, *changed, report); !done) return done;
    } else {
        report.next("let the broker read the change", "sudo systemctl restart mosquitto");
    }
    report.next("the bus itself is kept: `asipctl secure init` uses it again. To give it up for good",
                "rm -r " + folder->path().string());
    return {};
}

}  // namespace asip::cli
