// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/topic_rules.hpp"

#include <algorithm>
#include <utility>

namespace asip::cli {
namespace {

using bus::TopicKind;
using enum Right;

const Rights kReadOnly{kRead};
const Rights kWriteOnly{kWrite};
const Rights kBoth{kRead, kWrite};

constexpr const char* kQueue = "broker: a queue for each reader";
constexpr const char* kRetained = "broker: one message, retained";
constexpr const char* kAgentQueue = "agent: queue of 16 MiB";

/// What a board announces or reports: its own agent writes, everybody reads, a registry clears.
TopicRule reported(std::string topic, std::string memory, std::string processor, std::string disk) {
    return {std::move(topic),  {kWriteOfBoard},      kReadOnly,      kReadOnly, kBoth,
            std::move(memory), std::move(processor), std::move(disk)};
}

TopicRule announced(std::string topic, std::string memory, std::string processor, std::string disk) {
    auto rule = reported(std::move(topic), std::move(memory), std::move(processor), std::move(disk));
    rule.board = {kReadOfBoard, kWriteOfBoard};
    return rule;
}

TopicRule asked_of_board(std::string topic, std::string memory, std::string processor) {
    return {std::move(topic),
            {kReadOfBoard},
            {},
            kWriteOnly,
            {},
            std::move(memory),
            std::move(processor),
            "registry: a row of the history"};
}

TopicRule of_registry(std::string topic, std::string memory, std::string disk) {
    return {std::move(topic), {}, kReadOnly, kReadOnly, kBoth, std::move(memory), "each reader",
            std::move(disk)};
}

TopicRule asked_of_registry(std::string topic) {
    return {std::move(topic),
            {},
            kWriteOnly,
            kWriteOnly,
            kBoth,
            "registry: 32 questions of a user, an answer up to 256 KiB",
            "registry: an answer in turn; pages of 1,000 boards at most",
            "-"};
}

/// A new kind of topic without a row does not compile.
TopicRule rule_of(TopicKind kind) {
    switch (kind) {
        case TopicKind::kBoardNames:
            return {"servicebus", {}, kReadOnly, kReadOnly, kReadOnly, kQueue, "registry, gateway: a look-up",
                    "-"};
        case TopicKind::kServiceNames:
            return reported("servicebus/BOARD", "registry: 64 names of a board",
                            "registry, gateway: a look-up", "-");
        case TopicKind::kState:
            return announced("servicebus/BOARD/$state", kRetained,
                             "registry, gateway: a change for each watcher",
                             "registry: a row of the history");
        case TopicKind::kDescription:
            return announced("servicebus/BOARD/$description", "broker, registry, gateway: 64 KiB a board",
                             "registry, gateway: 64 KiB are read", "registry: a row of the history");
        case TopicKind::kStats:
            return reported("servicebus/BOARD/$stats", kRetained, "gateway: read when asked for", "-");
        case TopicKind::kLog:
            return reported("servicebus/BOARD/$log", kQueue, "each reader", "-");
        case TopicKind::kCommands:
            return reported("servicebus/BOARD/$commands", kQueue, "registry: read",
                            "registry: a row of the history");
        case TopicKind::kProperties:
            return announced("servicebus/BOARD/$properties", "broker, gateway: 128 KiB a board",
                             "each reader: 128 KiB are read", "-");
        case TopicKind::kValues:
            return announced("BOARD/$values", "broker, gateway: 32 KiB a board",
                             "each reader, at most ten times a second", "registry: values, each ten seconds");
        case TopicKind::kLinks:
            return announced("BOARD/$links", "broker, gateway: 256 KiB a board", "each reader", "-");
        case TopicKind::kLink:
            return {"BOARD/$link/USER/CLIENT",
                    {kReadOfBoard},
                    {},
                    {kWriteOwn},
                    {},
                    "agent: 100 links of 1.5 KiB, 50 of a user",
                    "agent: 20 commands a second and link",
                    "agent: a file for each link"};
        case TopicKind::kDemand:
            return {"servicebus/BOARD/$demand/USER/CLIENT",
                    {kReadOfBoard, kWriteOfBoard},
                    {kWriteOwn},
                    {kWriteOwn},
                    kBoth,
                    "broker: a retained one, until the agent reads it; agent: 1,024 demands",
                    "agent: reports up to its fastest period",
                    "-"};
        case TopicKind::kProbe:
            return {"servicebus/$probe",
                    kBoth,
                    kBoth,
                    kBoth,
                    kBoth,
                    "-",
                    "each agent: one announcement within 900 ms",
                    "-"};
        case TopicKind::kBoardOut:
            return reported("BOARD/out", kQueue, "each reader", "-");
        case TopicKind::kBoardIn:
            return asked_of_board("BOARD/in", kAgentQueue,
                                  "agent and board: 64 commands a client wait, in turn");
        case TopicKind::kStop:
            return asked_of_board("BOARD/$stop", "agent: 256 stops, 32 of a user",
                                  "agent and board: ahead of all others");
        case TopicKind::kServiceOut:
            return reported("BOARD/SERVICE/out", "gateway: the last value of each service", "each reader",
                            "-");
        case TopicKind::kServiceIn:
            return asked_of_board("BOARD/SERVICE/in", kAgentQueue,
                                  "agent and board: 64 commands a client wait, in turn");
        case TopicKind::kServiceError:
            return reported("BOARD/SERVICE/error", kQueue, "each reader", "-");
        case TopicKind::kServiceSet:
            return {"BOARD/SERVICE/set", {kReadOfBoard, kWriteOfBoard}, {}, {}, kBoth,
                    kRetained,           "agent, registry: cleared",    "-"};
        case TopicKind::kRegistryState:
            return of_registry("registry/ID/$state", kRetained, "-");
        case TopicKind::kRegistryStats:
            return of_registry("registry/ID/$stats", kRetained, "-");
        case TopicKind::kRegistryEvents:
            return of_registry("registry/ID/events", kQueue, "-");
        case TopicKind::kRegistryQuery:
            return asked_of_registry("registry/ID/query");
        case TopicKind::kAnyRegistryQuery:
            return asked_of_registry("registry/query");
    }
    return {};
}

constexpr std::size_t kKinds = static_cast<std::size_t>(TopicKind::kAnyRegistryQuery) + 1;

/// What a gateway shows other systems, and what they want. A gateway also clears what others left there.
std::vector<TopicRule> exported() {
    constexpr const char* kCommand = "gateway: a command, 50 a second";
    const auto rule = [](std::string topic, std::string processor, bool outside = false) {
        TopicRule made;
        made.topic = std::move(topic);
        made.memory = "broker: one message, retained";
        made.processor = std::move(processor);
        made.disk = "-";
        made.exporter = kBoth;
        made.outside = outside;
        return made;
    };
    const auto home = [&](std::string topic, Rights home_assistant, std::string processor,
                          bool outside = false) {
        auto made = rule(std::move(topic), std::move(processor), outside);
        made.home_assistant = std::move(home_assistant);
        return made;
    };
    // Consumers of things and Homie controllers are viewers and operators of the bus.
    const auto shown = [&](std::string topic, bool outside = false) {
        auto made = rule(std::move(topic), "each reader", outside);
        made.viewer = made.commander = kReadOnly;
        return made;
    };
    const auto asked = [&](std::string topic, bool outside = false) {
        auto made = rule(std::move(topic), kCommand, outside);
        made.commander = kWriteOnly;
        return made;
    };
    // So are Sparkplug hosts, which say themselves whether they are there. Only that is retained.
    const auto said = [&](const char* kind) {
        auto made = shown("spBv1.0/ID/" + std::string(kind), true);
        made.memory = kQueue;
        return made;
    };
    const auto wanted = [&](const char* kind, const char* processor) {
        auto made = said(kind);
        made.viewer = {};
        made.exporter = kReadOnly;
        made.commander = kWriteOnly;
        made.processor = processor;
        return made;
    };
    auto host = shown("spBv1.0/STATE/NAME", true);
    host.commander = kBoth;
    host.exporter = kReadOnly;
    // A registry keeps values of what dashboards show.
    auto dashboard = rule("export/dashboard/NAME", "gateway, registry: a dashboard of at most 32 KiB");
    dashboard.registry = kReadOnly;
    auto status = home("homeassistant/status", kBoth, "gateway: looks at what is retained", true);
    status.exporter = kReadOnly;
    return {home("export/ha/NAME", kReadOnly, "each reader"),
            home("export/ha/EXPORTED/NAME", kReadOnly, "each reader"),
            home("export/ha/EXPORTED/NAME/set", kWriteOnly, kCommand),
            home("homeassistant/device/NAME/config", kReadOnly, "Home Assistant: 128 KiB a board", true),
            std::move(status),
            std::move(dashboard),
            rule("export/homie/NAME", "gateway: which of several exports"),
            rule("export/homie/EXPORTED/NAME", "gateway: looks at what is retained"),
            shown("homie/5/EXPORTED/NAME", true),
            shown("homie/5/EXPORTED/ID/NAME", true),
            shown("homie/5/EXPORTED/ID/NAME/$target", true),
            asked("homie/5/EXPORTED/ID/NAME/set", true),
            rule("export/sparkplug/NAME", "gateway: which of several exports"),
            said("NBIRTH/NAME"),
            said("NDEATH/NAME"),
            said("DBIRTH/NAME/EXPORTED"),
            said("DDATA/NAME/EXPORTED"),
            said("DDEATH/NAME/EXPORTED"),
            wanted("NCMD/NAME", "gateway: all births, once a second at most"),
            wanted("DCMD/NAME/EXPORTED", kCommand),
            std::move(host)};
}

std::vector<TopicRule> all_rules() {
    std::vector<TopicRule> rules;
    for (std::size_t kind = 0; kind < kKinds; ++kind)
        rules.push_back(rule_of(static_cast<TopicKind>(kind)));
    for (const char* topic : {"registry/ID/forget", "registry/forget"})
        rules.push_back({topic,
                         {},
                         {},
                         kWriteOnly,
                         kReadOnly,
                         "registry: an answer",
                         "registry: 1,000 boards at most are forgotten",
                         "registry: a row of the history"});
    const Rights asks{kReadOwn};
    // A gateway has a level for each of its sessions.
    for (const char* topic : {"reply/USER/BOARD/CLIENT", "reply/USER/BOARD/CLIENT/PART"})
        rules.push_back({topic,
                         {kReadOwn, kWriteOfBoard},
                         asks,
                         asks,
                         {kReadOwn, kWriteRegistry},
                         kQueue,
                         "each reader: answers that it did not ask for are dropped",
                         "-"});
    for (auto& rule : exported())
        rules.push_back(std::move(rule));
    const Rights own{kReadOwn, kWriteOwn};
    for (const char* topic : {"reply/USER/$self/CLIENT", "reply/USER/$self/CLIENT/PART"})
        rules.push_back({topic, own, own, own, own, kQueue, "-", "-"});
    // The lines of boards hold for every user, unless they name the board.
    for (auto& rule : rules)
        for (const auto right : rule.board)
            if (right != kReadOfBoard && right != kWriteOfBoard) rule.home_assistant.push_back(right);
    return rules;
}

std::vector<std::string_view> levels_of(std::string_view topic) {
    std::vector<std::string_view> levels;
    for (std::size_t begin = 0; begin <= topic.size();) {
        const auto end = std::min(topic.find('/', begin), topic.size());
        levels.push_back(topic.substr(begin, end - begin));
        begin = end + 1;
    }
    return levels;
}

/// What stands in `topic` at the level that `rule` calls `name`.
std::string_view level_named(const TopicRule& rule, std::string_view topic, std::string_view name) {
    const auto names = levels_of(rule.topic);
    const auto levels = levels_of(topic);
    for (std::size_t i = 0; i < std::min(names.size(), levels.size()); ++i)
        if (names[i] == name) return levels[i];
    return {};
}

bool allows(const TopicRule& rule, const RoleOfUser& user, std::string_view topic, bool write) {
    if (user.role == Role::kAdmin) return true;
    if (write && user.boards && rule.of_some_boards())
        return user.boards->contains(std::string(level_named(rule, topic, "BOARD")));
    const auto rights = rule.of(user.boards ? Role::kViewer : user.role);
    return std::any_of(rights.begin(), rights.end(), [&](Right right) {
        switch (right) {
            case kRead:
                return !write;
            case kWrite:
                return write;
            case kReadOwn:
                return !write && level_named(rule, topic, "USER") == user.name;
            case kWriteOwn:
                return write && level_named(rule, topic, "USER") == user.name;
            case kReadOfBoard:
                return !write && level_named(rule, topic, "BOARD") == user.name;
            case kWriteOfBoard:
                return write && level_named(rule, topic, "BOARD") == user.name;
            case kWriteRegistry:
                return write && level_named(rule, topic, "BOARD") == "registry";
        }
        return false;
    });
}

}  // namespace

Rights TopicRule::of(Role role) const {
    switch (role) {
        case Role::kBoard:
            return board;
        case Role::kViewer:
            return viewer;
        case Role::kRegistry:
            return registry;
        case Role::kGateway: {
            auto rights = exporter;
            for (const auto right : commander)
                if (std::find(rights.begin(), rights.end(), right) == rights.end()) rights.push_back(right);
            return rights;
        }
        case Role::kHomeAssistant:
            return home_assistant;
        default:
            return commander;
    }
}

const std::vector<TopicRule>& topic_rules() {
    static const auto rules = all_rules();
    return rules;
}

bool may_read(const TopicRule& rule, const RoleOfUser& user, std::string_view topic) {
    return allows(rule, user, topic, false);
}
bool may_write(const TopicRule& rule, const RoleOfUser& user, std::string_view topic) {
    return allows(rule, user, topic, true);
}

}  // namespace asip::cli
