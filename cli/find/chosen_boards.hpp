// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "asip/bus/registry/label_selector.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/declaration.hpp"
#include "cli/find/target.hpp"

namespace asip::cli {

/// What -l says; nothing: not given.
using SelectorText = std::optional<std::string>;

void declare_selector(Declaration& verb, SelectorText& text);
/// Every board where it was not given. Fails with kExitUsage.
Outcome<bus::LabelSelector> parse_selector(const SelectorText& text);

/// By name; all with the service that the target names, if any. Fails with kExitNoAnswer where there are
/// none.
Outcome<std::vector<KnownBoard>> choose_boards(BoardSource& source, const Target& target,
                                               const bus::LabelSelector& labels);

}  // namespace asip::cli
