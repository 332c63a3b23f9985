// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cli/environment.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct SecureOptions {
    std::string action;              ///< init, add, revoke, renew, show, check or undo
    std::string what;                ///< a role, or a name
    std::vector<std::string> names;  ///< after a role
    std::string folder;              ///< empty: see SecureFolder
    std::string mosquitto;  ///< folder of the system broker's configuration; empty: where there is one
    std::vector<std::string> hosts;
    std::size_t port = 8883;
    std::optional<std::size_t> reload_pid;
    SelectorText selector{};  ///< add operator: of the boards with these labels
    bool here = false;        ///< add: for a service of this machine
    bool yes = false;         ///< init: changes the system without a question
    bool dry_run = false;     ///< init, undo: only say what would be done
    OutputOptions output{};
};

int run_secure(const SecureOptions& options, Environment& environment);

}  // namespace asip::cli
