// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "cli/ask/board_source.hpp"
#include "cli/environment.hpp"

namespace asip::cli {

/// BOARD or BOARD/SERVICE on a command line.
struct Target {
    std::string board;
    std::string service;  ///< empty: none given

    std::string text() const { return service.empty() ? board : board + "/" + service; }
    bool is_pattern() const;
    /// Without a service it means all of them.
    bool matches(std::string_view board_name, std::string_view service_name) const;
};

/// Fails with kExitUsage and a valid name near by. Wildcards only where `patterns`.
Outcome<Target> parse_target(std::string_view text, bool patterns = false);

/// Fails with kExitUsage where no board can match. `verb` is named where a service is given.
Outcome<void> check_board_pattern(std::string_view text, std::string_view verb);

/// By name or letter. Fails with kExitFailure and the nearest name.
Outcome<model::ServiceInfo> find_service(const KnownBoard& board, const std::string& name);

/// At blanks; `'...'` and `"..."` hold a word together.
Expected<std::vector<std::string>> split_words(std::string_view line);

}  // namespace asip::cli
