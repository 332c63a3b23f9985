// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/leftovers.hpp"

#include "asip/program/credentials.hpp"
#include "cli/ask/retained.hpp"

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
        // ROOT/servicebus/BOARD/$demand/USER/CLIENT, ROOT/reply/WHO ASKED/BOARD/CLIENT
        const bool demanded = topic.find("/$demand/" + user + "/") != std::string::npos;
        const auto answers = root + "/reply/";
        const bool answered =
            topic.starts_with(answers) && topic.find("/" + user + "/", answers.size()) != std::string::npos;
        if (of_board || demanded || answered) found.push_back(topic);
    }
    return found;
}

void clear_leftovers(const SecureFolder& folder, const SecuredBus& bus, const std::vector<std::string>& gone,
                     const Environment& environment, SecureReport& report) {
    const auto cannot = [&](const std::string& why) {
        report.next("what they left in the broker could not be cleared (" + why + ")",
                    "asipctl --credentials " + folder.credentials("admin").string() + " prune");
    };
    auto options = options_of(folder, "admin");
    if (!options) return cannot(options.error().text);
    Environment admin = environment;
    admin.mqtt = std::move(*options);
    admin.topics = bus::Topics(bus.topic_root);
    BusSession session(admin);
    session.on_connection_change({});
    if (const auto connected = session.connect(); !connected) return cannot(connected.error().text);
    const auto retained = read_retained(admin, session, {bus.topic_root + "/#"});
    if (!retained) return cannot(retained.error().text);
    std::vector<std::string> topics;
    for (const auto& message : *retained)
        topics.push_back(message.topic);
    for (const auto& name : gone) {
        const auto left = left_by(admin.topics, topics, name);
        if (left.empty()) continue;
        if (const auto cleared = clear_retained(admin, session, left); !cleared)
            return cannot(cleared.error().text);
        report.did("cleared", std::to_string(left.size()) +
                                  (left.size() == 1 ? " message that " : " messages that ") + name +
                                  " left in the broker");
    }
}

}  // namespace asip::cli
