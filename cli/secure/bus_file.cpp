// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/bus_file.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "asip/bus/topics.hpp"
#include "asip/model/json.hpp"
#include "asip/mqtt/options.hpp"
#include "cli/secure/sources.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

std::string text_member(const json& object, const char* name) {
    const auto found = object.find(name);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

Expected<SecuredUser> read_user(const json& object) {
    const auto role = parse_role(object.is_object() ? text_member(object, "role") : "");
    if (!role) return fail("a user without a role");
    SecuredUser user{text_member(object, "name"), *role, text_member(object, "password"),
                     text_member(object, "made")};
    if (const auto boards = object.find("boards"); boards != object.end()) {
        if (!boards->is_array()) return fail("user " + user.name + " has boards that are no list");
        user.boards.emplace();
        for (const auto& board : *boards) {
            if (!board.is_string() || !explain_user_name(board.get<std::string>(), Role::kBoard).empty())
                return fail("user " + user.name + " has a board without a valid name");
            user.boards->insert(board.get<std::string>());
        }
        user.selector = text_member(object, "selector");
    }
    if (!explain_user_name(user.name, user.role).empty()) return fail("a user without a valid name");
    if (user.hash.find_first_of(" \r\n") != std::string::npos || !user.hash.starts_with("$7$"))
        return fail("user " + user.name + " has no password");
    return user;
}

}  // namespace

const SecuredUser* SecuredBus::find(const std::string& name) const {
    const auto found =
        std::find_if(users.begin(), users.end(), [&name](const auto& user) { return user.name == name; });
    return found == users.end() ? nullptr : &*found;
}

std::string write_bus(const SecuredBus& bus) {
    auto users = json::array();
    for (const auto& user : bus.users) {
        users.push_back({{"name", user.name},
                         {"role", std::string(name_of(user.role))},
                         {"password", user.hash},
                         {"made", user.made}});
        if (user.boards) users.back().update({{"boards", *user.boards}, {"selector", user.selector}});
    }
    return model::dump_json_pretty({{"version", 1},
                                    {"hosts", bus.hosts},
                                    {"port", bus.port},
                                    {"topic_root", bus.topic_root},
                                    {"configuration", bus.configuration},
                                    {"users", users},
                                    {"reads", bus.reads}}) +
           "\n";
}

Expected<SecuredBus> read_bus(const std::string& text) {
    const auto document = model::parse_json(text, {.max_bytes = kMaxBytes, .max_depth = 4});
    if (!document) return fail(document.error());
    if (!document->is_object() || document->value("version", json()) != 1)
        return fail("not made by this version of asipctl");
    SecuredBus bus;
    for (const auto& host : document->value("hosts", json::array()))
        if (host.is_string()) bus.hosts.push_back(host.get<std::string>());
    if (bus.hosts.empty()) return fail("it names no host");
    const auto port = document->value("port", json());
    if (!port.is_number_unsigned() || port.get<std::uint64_t>() == 0 || port.get<std::uint64_t>() > 65535)
        return fail("it names no port");
    bus.port = port.get<std::uint16_t>();
    bus.topic_root = text_member(*document, "topic_root");
    if (!bus::Topics::valid_root(bus.topic_root)) return fail("it names no topic root");
    bus.configuration = text_member(*document, "configuration");
    for (const auto& object : document->value("users", json::array())) {
        auto user = read_user(object);
        if (!user) return fail(user.error());
        bus.users.push_back(std::move(*user));
    }
    const auto reads = document->value("reads", json::object());
    for (const auto& [board, sources] : reads.items())
        for (const auto& source : sources)
            if (source.is_string()) bus.reads[board].insert(source.get<std::string>());
    return bus;
}

std::string password_lines(const SecuredBus& bus) {
    std::string text;
    for (const auto& user : bus.users)
        text += user.name + ":" + user.hash + "\n";
    return text;
}

std::string rule_lines(const SecuredBus& bus) {
    std::vector<RoleOfUser> users;
    for (const auto& user : bus.users)
        if (user.role != Role::kBoard) users.push_back(user.with_rights());
    return access_rules(bus.topic_root, users) + source_rules(bus);
}

std::string broker_configuration(const BrokerPlaces& places) {
    std::string text =
        "# Mosquitto for boards and programs on several machines: TLS, a password for everybody, and rules "
        "of what\n"
        "# each user may do. asipctl secure makes the files named here.\n"
        "\n"
        "per_listener_settings false\n"
        "allow_anonymous false\n"
        "password_file " +
        places.passwords +
        "\n"
        "acl_file " +
        places.rules + "\n";
    if (places.local_port != 0) {
        text += "\n# For programs on this machine; passwords and rules hold here, too.\nlistener " +
                std::to_string(places.local_port) + " 127.0.0.1\n";
    }
    text += "\nlistener " + std::to_string(places.port) +
            "\n"
            "certfile " +
            places.certificate +
            "\n"
            "keyfile " +
            places.key +
            "\n"
            "tls_version tlsv1.2\n"
            "\n"
            "set_tcp_nodelay true\n"
            "persistence true\n";
    if (!places.store.empty()) text += "persistence_location " + places.store + "/\n";
    if (!places.pid_file.empty()) text += "pid_file " + places.pid_file + "\n";
    text +=
        "\n"
        "# A publisher can make the broker keep messages. The machine stays usable: beyond this limit the "
        "broker\n# refuses. Programs of ASIP leave no session behind; that of another program is kept for an "
        "hour.\n"
        "memory_limit " +
        std::to_string(places.memory_limit) +
        "\n"
        "persistent_client_expiration 1h\n"
        "\n"
        "autosave_interval 30\n"
        "# A number above all that waits, and not 0: with 0 Mosquitto closes the connection of a program "
        "whose QoS 1\n# message the rules deny.\n"
        "max_queued_messages 10000000\n"
        "max_queued_bytes 268435456\n"
        "# Lists of properties (128 KiB), exports of large boards and pages of a registry's answers are the "
        "largest\n# messages. A longer one only delays others, and its sender is disconnected. Programs take "
        "2 MiB: the limit here\n# must stay clearly below that, or else a message that is too large for a "
        "program stays in its way for ever.\n"
        "max_packet_size " +
        std::to_string(bus::kBrokerPacketBytes) + "\n";
    return text;
}

std::string with_reserve(std::string configuration) {
    constexpr std::string_view kName = "\nmemory_limit ";
    constexpr std::uint64_t kReserve = std::uint64_t{64} << 20;
    const auto begin = configuration.find(kName);
    if (begin == std::string::npos) return configuration;
    const auto digits = begin + kName.size();
    std::uint64_t limit = 0;
    const auto* end = configuration.data() + configuration.size();
    const auto [rest, error] = std::from_chars(configuration.data() + digits, end, limit);
    if (error != std::errc()) return configuration;
    const auto length = static_cast<std::size_t>(rest - configuration.data()) - digits;
    return configuration.replace(digits, length, std::to_string(limit + kReserve));
}

std::string credentials_text(const SecuredBus& bus, const SecuredUser& user, const std::string& password,
                             const std::string& authority) {
    const auto brokers = listed(bus.hosts, ",", [&bus](const auto& host) {
        return mqtt::BrokerAddress{host, bus.port, true}.describe();
    });
    std::string text = "# A program with this file is " + user.name +
                       " on the bus: keep it secret.\nrole = " + std::string(name_of(user.role)) +
                       "\nbroker = " + brokers + "\nuser = " + user.name + "\npassword = " + password +
                       "\ntopic-root = " + bus.topic_root + "\n";
    if (user.role == Role::kBoard) text += "name = " + user.name + "\n";
    return text + authority;
}

}  // namespace asip::cli
