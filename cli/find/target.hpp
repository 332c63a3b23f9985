// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "cli/ask/board_source.hpp"
#include "cli/environment.hpp"

namespace asip::cli {

/// What BOARD or BOARD/SERVICE on a command line means.
struct Target {
    std::string board;
    std::string service;  ///< empty: none given

    std::string text() const { return service.empty() ? board : board + "/" + service; }
    bool is_pattern() const;
    /// Whether a board, or a service of it, is meant; a target without service means all of them.
    bool matches(std::string_view board_name, std::string_view service_name) const;
};

/// Fails with kExitUsage and a valid name near by. Wildcards only where `patterns`.
Outcome<Target> parse_target(std::string_view text, bool patterns = false);

/// Fails, with kExitUsage, where no board can have a name that `text`, which may hold wildcards, matches.
/// `verb` is named where a service is given.
Outcome<void> check_board_pattern(std::string_view text, std::string_view verb);

/// The service of a board by name, or by its letter. Fails with kExitFailure and the nearest name.
Outcome<model::ServiceInfo> find_service(const KnownBoard& board, const std::string& name);

/// A line split into words at blanks; `'...'` and `"..."` hold a word together.
Expected<std::vector<std::string>> split_words(std::string_view line);

}  // namespace asip::cli
