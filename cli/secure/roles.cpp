// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/roles.hpp"

#include <algorithm>
#include <array>

#include "asip/model/names.hpp"

namespace asip::cli {
namespace {

struct Description {
    Role role;
    std::string_view name;
    std::string_view rights;
};

constexpr std::array<Description, 6> kRoles{{
    {Role::kBoard, "board",
     "announces and reports for the board of its name, receives what that board is asked"},
    {Role::kOperator, "operator", "reads what boards report, commands boards, asks registries"},
    {Role::kViewer, "viewer", "reads what boards report, asks registries"},
    {Role::kRegistry, "registry",
     "reads what boards report, clears what forgotten boards left, answers queries"},
    {Role::kGateway, "gateway", "reads what boards report, commands boards, asks registries"},
    {Role::kAdmin, "admin", "everything below the topic root"},
}};

const Description& description_of(Role role) {
    return *std::find_if(kRoles.begin(), kRoles.end(), [role](const auto& one) { return one.role == role; });
}

/// Lines of one section; "/" in front of a topic stands for the root.
using Lines = std::vector<std::pair<std::string_view, std::string_view>>;

const Lines kOwnBoard{
    {"write", "/servicebus/%u"}, {"readwrite", "/servicebus/%u/#"},
    {"write", "/%u/out"},        {"write", "/%u/+/out"},
    {"write", "/%u/+/error"},    {"read", "/%u/in"},
    {"read", "/%u/$stop"},       {"read", "/%u/+/in"},
    {"write", "/reply/+/%u/#"},
};
const Lines kEverybody{{"readwrite", "/servicebus/$probe"}, {"readwrite", "/reply/%u/#"}};
const Lines kReads{
    {"read", "/servicebus/#"},
    {"read", "/registry/+/$state"},
    {"read", "/registry/+/$stats"},
    {"read", "/registry/+/events"},
    {"read", "/+/out"},
    {"read", "/+/+/out"},
    {"read", "/+/+/error"},
    {"write", "/registry/query"},
    {"write", "/registry/+/query"},
    {"write", "/servicebus/+/$demand/%u/#"},
};
const Lines kCommands{{"write", "/+/in"}, {"write", "/+/+/in"}, {"write", "/+/$stop"}};
/// No line tells an empty message from another: who may clear what a board left may also report for it.
/// Nobody needs to command for that: agents refuse commands that are retained.
const Lines kRegistry{
    {"read", "/servicebus/#"},        {"write", "/servicebus/+/#"}, {"readwrite", "/+/out"},
    {"readwrite", "/+/+/out"},        {"readwrite", "/+/+/error"},  {"readwrite", "/registry/#"},
    {"write", "/reply/+/registry/#"},
};
const Lines kEverything{{"readwrite", "/#"}};

/// A person must not announce a board of its own name, which the rules for boards would allow.
const Lines kNoBoard{{"deny", "/servicebus/%u/#"}, {"deny", "/%u/#"}, {"deny", "/reply/+/%u/#"}};

std::string written(const Lines& lines, std::string_view word, const std::string& root,
                    std::string_view user) {
    std::string text;
    for (const auto& [access, topic] : lines) {
        std::string whole = root + std::string(topic);
        const auto place = whole.find("%u");
        if (!user.empty() && place != std::string::npos) whole.replace(place, 2, user);
        text.append(word).append(" ").append(access).append(" ").append(whole).append("\n");
    }
    return text;
}

std::string section(const RoleOfUser& user, const std::string& root) {
    std::string text = "\n# " + user.name + ", " + std::string(name_of(user.role)) + ": " +
                       std::string(rights_of(user.role)) + "\nuser " + user.name + "\n";
    const auto add = [&](const Lines& lines) { text += written(lines, "topic", root, user.name); };
    switch (user.role) {
        case Role::kBoard:
            return {};
        case Role::kRegistry:
            add(kRegistry);
            break;
        case Role::kAdmin:
            add(kEverything);
            break;
        case Role::kOperator:
        case Role::kGateway:
            add(kNoBoard);
            add(kReads);
            add(kCommands);
            break;
        case Role::kViewer:
            add(kNoBoard);
            add(kReads);
            break;
    }
    return text;
}

}  // namespace

std::string_view name_of(Role role) {
    return description_of(role).name;
}

std::optional<Role> parse_role(std::string_view word) {
    for (const auto& one : kRoles) {
        if (one.name == word) return one.role;
    }
    return std::nullopt;
}

std::string_view rights_of(Role role) {
    return description_of(role).rights;
}

std::string explain_user_name(std::string_view name, Role role) {
    if (role == Role::kRegistry && name == "registry") return {};
    if (name == "reply") return "'reply' is reserved: answers come below it";
    // ROOT/reply/USER/in would match ROOT/+/+/in.
    if (name == "in" || name == "out" || name == "error")
        return "'" + std::string(name) + "' is reserved: it ends the topics of services";
    if (name == "broker") return "'broker' is reserved for the broker itself";
    return model::explain_board_name(name);
}

std::string access_rules(const std::string& root, const std::vector<RoleOfUser>& users) {
    std::string text =
        "# Who may do what on the bus, made by asipctl secure. `pattern` lines hold for every user, %u being "
        "the\n"
        "# user's name; lines below `user NAME` hold for that user besides. What no line allows is refused.\n"
        "\n"
        "# An agent's user is called as its board is: user greenhouse speaks for board greenhouse and no "
        "other.\n";
    text += written(kOwnBoard, "pattern", root, {});
    text += "\n# Probing, and reading the answers to one's own questions: " + root +
            "/reply/WHO ASKED/WHO ANSWERS/... "
            "Names\n# of boards on " +
            root +
            "/servicebus itself are for a bus without rules: no line could tie them to "
            "their sender.\n";
    text += written(kEverybody, "pattern", root, {});
    for (const auto& user : users)
        text += section(user, root);
    return text;
}

}  // namespace asip::cli
