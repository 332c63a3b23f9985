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

/// What was given by -l; nothing: no such option.
using SelectorText = std::optional<std::string>;

/// Declares `-l,--selector`.
void declare_selector(Declaration& verb, SelectorText& text);
/// Every board where it was not given. Fails with kExitUsage.
Outcome<bus::LabelSelector> parse_selector(const SelectorText& text);

/// The boards that a target, which may hold wildcards, and a selector mean: all of them with such a service,
/// where the target names one. In the order of their names. Fails with kExitNoAnswer where there are none.
Outcome<std::vector<KnownBoard>> choose_boards(BoardSource& source, const Target& target,
                                               const bus::LabelSelector& labels);

}  // namespace asip::cli
