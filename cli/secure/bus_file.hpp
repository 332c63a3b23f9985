// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "cli/secure/roles.hpp"

namespace asip::cli {

/// Its password stands in the credentials file alone.
struct SecuredUser {
    std::string name;
    Role role = Role::kViewer;
    std::string hash;        ///< see mosquitto_hash()
    std::string made;        ///< ISO 8601
    SomeBoards boards{};     ///< those that an operator commands
    std::string selector{};  ///< labels by which they were found, for the command that finds them again

    RoleOfUser with_rights() const { return {name, role, boards}; }
};

/// Everything that the broker reads follows from it.
struct SecuredBus {
    std::vector<std::string> hosts;  ///< names and addresses of the broker, best first
    std::uint16_t port = 8883;
    std::string topic_root = "asip";
    std::string configuration;                             ///< file of Mosquitto's configuration
    std::vector<SecuredUser> users;                        ///< in the order in which they were added
    std::map<std::string, std::set<std::string>> reads{};  ///< boards that the agent of a board may hear

    const SecuredUser* find(const std::string& name) const;
};

std::string write_bus(const SecuredBus& bus);
Expected<SecuredBus> read_bus(const std::string& text);

std::string password_lines(const SecuredBus& bus);
std::string rule_lines(const SecuredBus& bus);

/// Where the files are that the configuration names.
struct BrokerPlaces {
    std::string passwords, rules, certificate, key;
    std::string store;  ///< folder of what the broker keeps; empty: a configuration around this one names it
    std::string pid_file;                                   ///< empty: likewise
    std::uint64_t memory_limit = std::uint64_t{512} << 20;  ///< of the broker, in bytes
    std::uint16_t port = 8883;                              ///< with TLS, for everybody
    std::uint16_t local_port = 0;                           ///< without TLS, for this machine only; 0: none
};
std::string broker_configuration(const BrokerPlaces& places);
/// With a larger `memory_limit`, if any: where others have filled Mosquitto, the program that clears it could
/// not come in.
std::string with_reserve(std::string configuration);

/// For read_credentials().
std::string credentials_text(const SecuredBus& bus, const SecuredUser& user, const std::string& password,
                             const std::string& authority);

}  // namespace asip::cli
