// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/topics.hpp"
#include "cli/secure/roles.hpp"

namespace asip::cli {

/// What users may do with a topic. A level called USER, BOARD or ID stands for a name.
enum class Right {
    kRead,
    kWrite,
    kReadOwn,        ///< where USER is the user
    kWriteOwn,       ///< likewise
    kReadOfBoard,    ///< where BOARD is the user
    kWriteOfBoard,   ///< likewise
    kWriteRegistry,  ///< where BOARD is `registry`: an answer of a registry
};
using Rights = std::vector<Right>;

/// The single source of the access rules, of what is tried at a running broker, and of the table in
/// SECURITY.md.
struct TopicRule {
    std::string topic;                          ///< below the topic root: `servicebus/BOARD/$state`
    Rights board, viewer, commander, registry;  ///< `commander`: operators and gateways
    /// What a message on it can cost, beyond the time to read it: in the broker, and in which program.
    std::string memory, processor, disk;
    Rights exporter{};        ///< gateways, beyond what a commander may
    Rights home_assistant{};  ///< Home Assistant, which may nothing else
    bool outside = false;     ///< `topic` stands beside the topic root, not below it

    /// Where an operator of some boards commands these. Labels, firmware and what resumes a board come on
    /// BOARD/in: those are for operators of all boards.
    bool of_some_boards() const { return topic == "BOARD/$stop" || topic == "BOARD/SERVICE/in"; }
    Rights of(Role role) const;  ///< not for Role::kAdmin, who may do everything
};

/// The rules of each kind of topic, and of those of answers.
const std::vector<TopicRule>& topic_rules();

/// Whether a user of this role and name may read (write) on this topic, which follows `rule` and has no root.
bool may_read(const TopicRule& rule, const RoleOfUser& user, std::string_view topic);
bool may_write(const TopicRule& rule, const RoleOfUser& user, std::string_view topic);

}  // namespace asip::cli
