// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "cli/complete.hpp"

namespace asip::cli {

/// Longest line that the shell takes, in bytes.
inline constexpr std::size_t kMaxShellLine = 8192;

/// Commands that only the shell has: `exit`, `quit`, `values`.
const std::vector<std::string>& shell_commands();

/// The words of a line. Fails for a quote that is never closed, for control characters and for a line that is
/// too long.
Expected<std::vector<std::string>> shell_words(std::string_view line);

/// What asipctl would be called with, of a command about `board`: `distance measure` is `send
/// BOARD/distance measure`, `get distance` is `get BOARD/distance`, `pin 13 high` is `pin BOARD 13 high`.
/// A first word that is no verb is a service. A word that names the board already stays as it is. Pure.
std::vector<std::string> expand_words(const CLI::App& app, const std::vector<std::string>& words,
                                      const std::string& board);

/// What the last word of `typed`, the line up to the cursor, may become. Pure but for the sources.
std::vector<std::string> complete_shell(const CLI::App& app, const std::string& typed,
                                        const std::string& board, const NameSources& names);

}  // namespace asip::cli
