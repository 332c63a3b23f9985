// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/roles.hpp"

#include <algorithm>
#include <array>
#include <ranges>
#include <utility>

#include "asip/model/names.hpp"
#include "cli/secure/topic_rules.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

struct Description {
    Role role;
    std::string_view name;
    std::string_view rights;
};

constexpr std::array<Description, 7> kRoles{{
    {Role::kBoard, "board",
     "announces and reports for the board of its name, receives what that board is asked"},
    {Role::kOperator, "operator", "reads what boards report, commands boards, asks registries"},
    {Role::kViewer, "viewer", "reads what boards report, asks registries"},
    {Role::kRegistry, "registry",
     "reads what boards report, clears what forgotten boards left, answers queries"},
    {Role::kGateway, "gateway", "reads what boards report, commands boards, asks registries, exports boards"},
    {Role::kHomeAssistant, "home-assistant", "sees and sets what a gateway exports to Home Assistant"},
    {Role::kAdmin, "admin", "everything below the topic root"},
}};

const Description& description_of(Role role) {
    return *std::find_if(kRoles.begin(), kRoles.end(), [role](const auto& one) { return one.role == role; });
}

/// A person must not announce a board of its own name, which the rules for boards would allow.
constexpr std::array<std::string_view, 3> kNoBoard{"servicebus/%u/#", "%u/#", "reply/+/%u/#"};

/// `+` in place of a board matches what is no board, too: the levels at which the bus has other things.
constexpr std::array<std::string_view, 12> kNoCommand{
    "servicebus/in", "servicebus/$stop", "servicebus/+/in", "registry/in", "registry/$stop", "registry/+/in",
    "reply/in",      "reply/$stop",      "reply/+/in",      "export/in",   "export/$stop",   "export/+/in"};

/// A line of Mosquitto's rules for what a right allows on a topic. `user`: empty in lines that hold for all.
std::string line_for(const TopicRule& rule, std::string_view access, Right right, const std::string& root,
                     const std::string& user) {
    const bool of_user = right == Right::kReadOwn || right == Right::kWriteOwn;
    const bool of_board = right == Right::kReadOfBoard || right == Right::kWriteOfBoard;
    const std::string own = user.empty() ? "%u" : user;
    std::string text = (user.empty() ? "pattern " : "topic ") + std::string(access) + " ";
    if (!rule.outside) text += root + "/";
    bool first = true;
    for (const auto level : std::views::split(std::string_view(rule.topic), '/')) {
        const std::string_view name(level.begin(), level.end());
        if (!std::exchange(first, false)) text += '/';
        if (name == "BOARD" && right == Right::kWriteRegistry) {
            text += "registry";
        } else if ((name == "USER" && of_user) || (name == "BOARD" && of_board)) {
            text += own;
        } else {
            const bool any = name == "BOARD" || name == "SERVICE" || name == "USER" || name == "CLIENT" ||
                             name == "PART" || name == "ID" || name == "EXPORTED" || name == "NAME";
            text += any ? "+" : name;
        }
    }
    return text + "\n";
}

bool reads(Right right) {
    return right == Right::kRead || right == Right::kReadOwn || right == Right::kReadOfBoard;
}

/// Reading and writing on the same topic is one line: the broker goes through all of them for each message.
std::string lines_for(const TopicRule& rule, const Rights& rights, const std::string& root,
                      const std::string& user) {
    std::string text;
    std::string read;
    for (const auto right : rights)
        if (reads(right)) read = line_for(rule, "read", right, root, user);
    std::string write;
    for (const auto right : rights)
        if (!reads(right)) write = line_for(rule, "write", right, root, user);
    const auto topic = [](const std::string& line) { return line.substr(line.rfind(' ') + 1); };
    if (read.empty() || write.empty() || topic(read) != topic(write)) return read + write;
    return write.replace(write.find(" write "), 7, " readwrite ");
}

/// What a board may everybody may: its lines hold for each user. Of the rights of another role those are
/// left.
Rights beyond_all(const TopicRule& rule, Role role) {
    auto rights = rule.of(role);
    std::erase_if(rights, [&](Right right) {
        return std::find(rule.board.begin(), rule.board.end(), right) != rule.board.end();
    });
    return rights;
}

/// A viewer's lines, and those that command these boards.
std::string lines_of_boards(const RoleOfUser& user, const std::string& root) {
    std::string text;
    for (const auto& rule : topic_rules()) {
        text += lines_for(rule, beyond_all(rule, Role::kViewer), root, user.name);
        if (!rule.of_some_boards()) continue;
        for (const auto& board : *user.boards)
            text += line_for(rule, "write", Right::kWriteOfBoard, root, board);
    }
    return text;
}

std::string section(const RoleOfUser& user, const std::string& root) {
    std::string text = "\n# " + user.name + ", " + std::string(name_of(user.role)) + ": " + rights_of(user) +
                       "\nuser " + user.name + "\n";
    if (user.role == Role::kBoard) return {};
    if (user.role == Role::kAdmin) {
        text += "topic readwrite " + root + "/#\n";
        for (const auto& rule : topic_rules())
            if (rule.outside) text += line_for(rule, "readwrite", Right::kWrite, root, user.name);
        return text;
    }
    // A registry clears what is left of boards. No line tells an empty message from another: a registry may
    // therefore also report for a board.
    if (user.role != Role::kRegistry) {
        for (const auto topic : kNoBoard) {
            std::string whole(topic);
            text += "topic deny " + root + "/" + whole.replace(whole.find("%u"), 2, user.name) + "\n";
        }
    }
    if (user.boards) return text + lines_of_boards(user, root);
    if (user.role == Role::kOperator || user.role == Role::kGateway)
        for (const auto topic : kNoCommand)
            text += "topic deny " + root + "/" + std::string(topic) + "\n";
    for (const auto& rule : topic_rules())
        text += lines_for(rule, beyond_all(rule, user.role), root, user.name);
    return text;
}

}  // namespace

std::string_view name_of(Role role) {
    return description_of(role).name;
}

std::optional<Role> parse_role(std::string_view word) {
    for (const auto& one : kRoles)
        if (one.name == word) return one.role;
    return std::nullopt;
}

std::string rights_of(const RoleOfUser& user) {
    if (!user.boards) return std::string(description_of(user.role).rights);
    return "reads what boards report, asks registries, commands and stops " +
           (user.boards->empty() ? "no board" : listed(*user.boards));
}

std::string explain_user_name(std::string_view name, Role role) {
    if (role == Role::kRegistry && name == "registry") return {};
    if (name == "reply") return "'reply' is reserved: answers come below it";
    if (name == "export") return "'export' is reserved: what gateways export is below it";
    // ROOT/reply/USER/in would match ROOT/+/+/in.
    if (name == "in" || name == "out" || name == "error" || name == "set")
        return "'" + std::string(name) + "' is reserved: it ends the topics of services";
    if (name == "broker") return "'broker' is reserved for the broker itself";
    return model::explain_board_name(name);
}

std::string access_rules(const std::string& root, const std::vector<RoleOfUser>& users) {
    std::string text =
        "# What each user may do on the bus, made by asipctl secure. `pattern` lines hold for every user, %u "
        "being\n"
        "# the user's name; lines below `user NAME` hold for that user besides. What no line allows is "
        "refused.\n"
        "\n"
        "# An agent's user is called as its board is: user greenhouse speaks for board greenhouse and no "
        "other.\n"
        "# Everybody probes, and reads the answers to questions of their own: " +
        root + "/reply/USER/ANSWERER/... Names\n# of boards on " + root +
        "/servicebus itself are for a bus without rules: no line could tie them to their sender.\n";
    for (const auto& rule : topic_rules())
        text += lines_for(rule, rule.board, root, {});
    for (const auto& user : users)
        text += section(user, root);
    return text;
}

}  // namespace asip::cli
