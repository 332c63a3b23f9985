// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace asip::cli {

/// Access rules follow from it and the user's name.
enum class Role {
    kBoard,          ///< the agent of the board that is named like the user
    kOperator,       ///< reads what boards report and commands them
    kViewer,         ///< reads what boards report
    kRegistry,       ///< asip-registry
    kGateway,        ///< asip-gateway
    kHomeAssistant,  ///< Home Assistant, for which a gateway exports
    kAdmin           ///< everything below the topic root
};

std::string_view name_of(Role role);  ///< `board`, `operator`, ...
std::optional<Role> parse_role(std::string_view word);

/// Nothing: every board.
using SomeBoards = std::optional<std::set<std::string>>;

struct RoleOfUser {
    std::string name;
    Role role = Role::kViewer;
    SomeBoards boards{};  ///< those that an operator commands
};

/// "reads what boards report, commands boards".
std::string rights_of(const RoleOfUser& user);
/// Empty: it can. Names are those of boards; `registry` is left to registries.
std::string explain_user_name(std::string_view name, Role role);

/// For Mosquitto's `acl_file`, below `root`. Boards need no line of their own: a broker takes 5 s to read
/// 5,000.
std::string access_rules(const std::string& root, const std::vector<RoleOfUser>& users);

}  // namespace asip::cli
