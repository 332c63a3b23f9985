// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace asip::cli {

/// What a user of the broker is. The access rules follow from it and from the user's name alone.
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
/// One sentence part for a person: "reads what boards report, commands boards".
std::string_view rights_of(Role role);

struct RoleOfUser {
    std::string name;
    Role role = Role::kViewer;
};

/// Why this name cannot be one of a user with this role; empty: it can. Names are those of boards, and
/// `registry` is left to registries: rules for boards are written for the user called like the board.
std::string explain_user_name(std::string_view name, Role role);

/// The access rules for Mosquitto (its `acl_file`) of all users, below the topic root `root`. A board needs
/// no line of its own, so that the file does not grow with them: a broker with 5,000 users in it takes 5 s to
/// read it.
std::string access_rules(const std::string& root, const std::vector<RoleOfUser>& users);

}  // namespace asip::cli
