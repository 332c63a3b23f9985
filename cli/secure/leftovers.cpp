// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/leftovers.hpp"

#include <map>
#include <optional>

#include "asip/program/credentials.hpp"
#include "asip/text/file_text.hpp"
#include "cli/secure/bus_file.hpp"
#include "cli/secure/reload.hpp"
#include "cli/secure/sources.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

constexpr Duration kBrokerPatience = std::chrono::seconds(5);
constexpr Duration kBrokerPause = std::chrono::milliseconds(500);

}  // namespace

Outcome<mqtt::Options> options_of(const SecureFolder& folder, const std::string& user) {
    const auto file = folder.credentials(user).string();
    const auto read = program::read_credentials(file);
    if (!read) return failure(program::kExitFailure, read.error());
    program::BrokerOptions raw;
    raw.brokers = read->brokers;
    raw.user = read->user;
    raw.password = read->password;
    raw.ca = file;
    raw.mqtt_version = "5";
    auto options = program::mqtt_options(raw, "asipctl");
    if (!options) return failure(program::kExitUsage, options.error());
    return std::move(*options);
}

std::vector<std::string> filters_of(const bus::Topics& topics, const std::string& user) {
    const auto& root = topics.root();
    return {root + "/servicebus/" + user + "/#", root + "/" + user + "/#", root + "/reply/" + user + "/#",
            // ROOT/servicebus/BOARD/$demand/USER/CLIENT, ROOT/BOARD/$link/USER/CLIENT,
            // ROOT/reply/USER/BOARD/CLIENT
            root + "/servicebus/+/$demand/" + user + "/#", root + "/+/$link/" + user + "/#",
            root + "/reply/+/" + user + "/#"};
}

std::string unnamed_of(const bus::Topics& topics, const std::vector<Retained>& retained, Role role) {
    const bool commands = role != Role::kBoard && role != Role::kViewer && role != Role::kRegistry;
    const bool exports = role == Role::kGateway || role == Role::kHomeAssistant || role == Role::kAdmin;
    const bool registries = role == Role::kRegistry || role == Role::kAdmin;
    std::map<std::string, std::size_t> found;
    for (const auto& one : find_lingering(topics, retained)) {
        const bool named = one.topic.find("/$demand/") != std::string::npos ||  // by its USER: filters_of()
                           one.topic.find("/$link/") != std::string::npos;
        if (commands && !named && one.kind == Lingering::Kind::kCommand) ++found["command"];
        if (registries && one.kind == Lingering::Kind::kGoneRegistry) ++found["message"];
    }
    for (const auto& message : retained) {
        if (!exports || message.topic.ends_with("/set")) continue;
        if (message.topic.starts_with(topics.root() + "/export/dashboard/")) continue;  // of people
        if (message.topic.starts_with(topics.root() + "/export/") ||
            message.topic.starts_with("homeassistant/device/"))
            ++found["export"];
    }
    std::string words;
    for (const auto& [what, count] : found)
        words += (words.empty() ? "" : ", ") + counted(count, what) +
                 (what == "message" ? " of a registry that is gone" : "");
    return words;
}

namespace {

void clear_leftovers(const SecureFolder& folder, const SecuredBus& bus, const std::vector<RoleOfUser>& gone,
                     const Environment& environment, SecureReport& report) {
    const auto as_admin = "asipctl --credentials " + folder.credentials("admin").string();
    const auto cannot = [&](const std::string& why) {
        std::string names;
        for (const auto& user : gone)
            names += " " + user.name;
        report.next("what they left in the broker could not be cleared (" + why +
                        "); where the broker has no memory left, give it more (memory_limit in " +
                        bus.configuration + ") and start it again. Then repeat",
                    "asipctl secure revoke" + names + " --dir " + folder.path().string());
    };
    auto options = options_of(folder, "admin");
    if (!options) return cannot(options.error().text);
    Environment admin = environment;
    admin.mqtt = std::move(*options);
    admin.topics = bus::Topics(bus.topic_root);
    // A broker without memory may have ended, and be started again by systemd.
    std::optional<BusSession> session;
    Outcome<void> connected;
    const auto until = Clock::now() + kBrokerPatience;
    for (;;) {
        session.emplace(admin);
        session->on_connection_change({});
        connected = session->connect();
        if (connected || session->stopped() || Clock::now() >= until) break;
        session->run_for(kBrokerPause);
    }
    if (!connected) return cannot(connected.error().text);
    for (const auto& [name, role, boards] : gone) {
        const auto left = clear_all_retained(admin, *session, filters_of(admin.topics, name));
        if (!left) return cannot(left.error().text);
        clear_links(admin, *session, name, folder.path().string(), report);
        if (*left > 0)
            report.did("cleared", counted(*left, "message") + " that " + name + " left in the broker");
    }
    const auto retained = read_retained(admin, *session, {bus.topic_root + "/#", "homeassistant/device/#"});
    if (!retained) return cannot(retained.error().text);
    for (const auto& [name, role, boards] : gone) {
        const auto unnamed = unnamed_of(admin.topics, *retained, role);
        if (unnamed.empty()) continue;
        report.next(
            "the broker keeps " + unnamed + "; " + name +
                " may have left them, and no topic says it: look at them, and clear what no program needs",
            as_admin + " forget --leftovers --dry-run");
        if (unnamed.find("export") != std::string::npos)
            report.next("what a gateway exported is cleared by",
                        "asip-gateway clean --credentials " + folder.credentials("admin").string());
    }
}

}  // namespace

Outcome<void> reload_and_clear(const SecureFolder& folder, const SecuredBus& bus,
                               std::optional<std::size_t> pid, const std::vector<RoleOfUser>& gone,
                               const Environment& environment, SecureReport& report) {
    const auto configured = text::file_text(bus.configuration);
    const auto write = [&](const std::string& text) {
        return folder.write(bus.configuration, text, SecureFolder::Readers::kAll);
    };
    if (configured)
        if (auto done = write(with_reserve(*configured)); !done) return tl::unexpected(done.error());
    const bool reloaded = report_reload(folder, bus, pid, report);
    if (reloaded) clear_leftovers(folder, bus, gone, environment, report);
    if (configured)
        if (auto done = write(*configured); !done) return tl::unexpected(done.error());
    if (reloaded) reload_broker(folder, bus, pid);
    return {};
}

}  // namespace asip::cli
