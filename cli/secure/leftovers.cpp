// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/leftovers.hpp"

#include <algorithm>
#include <map>

#include "asip/program/credentials.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {

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

std::vector<std::string> left_by(const bus::Topics& topics, const std::vector<std::string>& retained,
                                 const std::string& user) {
    const auto& root = topics.root();
    const std::vector<std::string> own{root + "/servicebus/" + user, root + "/" + user,
                                       root + "/reply/" + user};
    const auto is_below = [](std::string_view topic, std::string_view parent) {
        return topic.starts_with(parent) && (topic.size() == parent.size() || topic[parent.size()] == '/');
    };
    std::vector<std::string> found;
    for (const auto& topic : retained) {
        const bool of_board =
            std::any_of(own.begin(), own.end(), [&](const auto& parent) { return is_below(topic, parent); });
        // ROOT/servicebus/BOARD/$demand/USER/CLIENT, ROOT/reply/USER/BOARD/CLIENT
        const bool demanded = topic.find("/$demand/" + user + "/") != std::string::npos;
        const auto answers = root + "/reply/";
        const bool answered =
            topic.starts_with(answers) && topic.find("/" + user + "/", answers.size()) != std::string::npos;
        if (of_board || demanded || answered) found.push_back(topic);
    }
    return found;
}

std::string unnamed_of(const bus::Topics& topics, const std::vector<Retained>& retained, Role role) {
    const bool commands = role != Role::kBoard && role != Role::kViewer && role != Role::kRegistry;
    const bool exports = role == Role::kGateway || role == Role::kHomeAssistant || role == Role::kAdmin;
    const bool registries = role == Role::kRegistry || role == Role::kAdmin;
    std::map<std::string, std::size_t> found;
    for (const auto& one : find_lingering(topics, retained)) {
        const bool named = one.topic.find("/$demand/") != std::string::npos;  // by its USER: left_by()
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

void clear_leftovers(const SecureFolder& folder, const SecuredBus& bus, const std::vector<RoleOfUser>& gone,
                     const Environment& environment, SecureReport& report) {
    const auto as_admin = "asipctl --credentials " + folder.credentials("admin").string();
    const auto cannot = [&](const std::string& why) {
        report.next("what they left in the broker could not be cleared (" + why + ")", as_admin + " prune");
    };
    auto options = options_of(folder, "admin");
    if (!options) return cannot(options.error().text);
    Environment admin = environment;
    admin.mqtt = std::move(*options);
    admin.topics = bus::Topics(bus.topic_root);
    BusSession session(admin);
    session.on_connection_change({});
    if (const auto connected = session.connect(); !connected) return cannot(connected.error().text);
    auto retained = read_retained(admin, session, {bus.topic_root + "/#", "homeassistant/device/#"});
    if (!retained) return cannot(retained.error().text);
    for (const auto& [name, role] : gone) {
        std::vector<std::string> topics;
        for (const auto& message : *retained)
            topics.push_back(message.topic);
        const auto left = left_by(admin.topics, topics, name);
        if (!left.empty()) {
            if (const auto cleared = clear_retained(admin, session, left); !cleared)
                return cannot(cleared.error().text);
            report.did("cleared", std::to_string(left.size()) +
                                      (left.size() == 1 ? " message that " : " messages that ") + name +
                                      " left in the broker");
        }
        std::erase_if(*retained, [&](const Retained& message) {
            return std::find(left.begin(), left.end(), message.topic) != left.end();
        });
        const auto unnamed = unnamed_of(admin.topics, *retained, role);
        if (unnamed.empty()) continue;
        report.next(
            "the broker keeps " + unnamed + "; " + name +
                " may have left them, and no topic says it: look at them, and clear what no program needs",
            as_admin + " prune --dry-run");
        if (unnamed.find("export") != std::string::npos)
            report.next("what a gateway exported is cleared by",
                        "asip-gateway clean --credentials " + folder.credentials("admin").string());
    }
}

}  // namespace asip::cli
