// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "cli/secure/roles.hpp"

namespace asip::cli {

/// No service can be called so: what is published for it harms no board.
inline constexpr const char* kNoService = "$check";

/// What a user should, or should not, be able to do: one row of `asipctl secure check`.
struct Trial {
    std::string user;  ///< empty: a connection without user
    std::string what;  ///< for a person: "command boards"
    bool allowed = false;
    /// Topics that it publishes on; all of them or none must be accepted.
    std::vector<std::string> publishes;
    /// Topics whose messages reach it; likewise. With neither: whether it may connect at all.
    std::vector<std::string> reads;
};

/// The trials of one user. `stranger` is the name of a board that does not exist: whatever is published for
/// it harms no board.
std::vector<Trial> trials_of(const RoleOfUser& user, const std::string& root, const std::string& stranger);

}  // namespace asip::cli
