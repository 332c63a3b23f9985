// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/registry/label_selector.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/declaration.hpp"
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

/// What -l says; nothing: not given.
using SelectorText = std::optional<std::string>;

void declare_selector(Declaration& verb, SelectorText& text);
/// Every board where it was not given. Fails with kExitUsage.
Outcome<bus::LabelSelector> parse_selector(const SelectorText& text);

/// By name; all with the service that the target names, if any. Fails with kExitNoAnswer where there are
/// none.
Outcome<std::vector<KnownBoard>> choose_boards(BoardSource& source, const Target& target,
                                               const bus::LabelSelector& labels);

/// By name or letter. Fails with kExitFailure and the nearest name.
Outcome<model::ServiceInfo> find_service(const KnownBoard& board, const std::string& name);

/// At blanks; `'...'` and `"..."` hold a word together.
Expected<std::vector<std::string>> split_words(std::string_view line);

}  // namespace asip::cli
