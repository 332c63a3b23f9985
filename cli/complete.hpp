// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cli/command_line.hpp"

namespace asip::cli {

/// From the bus or from models, asked when needed.
struct NameSources {
    using Names = std::vector<std::string>;
    std::function<Names()> boards;
    std::function<Names(const std::string& board)> services;
    std::function<Names(const std::string& board, const std::string& service)> commands;
    std::function<Names(const std::string& board, const std::string& service)> fields;
    std::function<Names()> kinds;
    std::function<Names()> units;
    std::function<Names()> labels;  ///< `room=lab`, of all boards
};

/// In place of words.
inline constexpr const char* kOfferFiles = ":files";
inline constexpr const char* kOfferFolders = ":folders";

/// What `start` may become behind `words`: sorted words, or kOfferFiles or kOfferFolders alone. Pure but for
/// the sources.
std::vector<std::string> complete(const CLI::App& app, const std::vector<std::string>& words,
                                  const std::string& start, const NameSources& names);

/// Up to the cursor, as bash, zsh and fish read it: whole words, and the beginning of the next. An open quote
/// counts as closed.
struct ShellLine {
    std::vector<std::string> words;
    std::string start;
    char quote = '\0';         ///< that is still open
    std::size_t unquoted = 0;  ///< so many bytes of `start` stand in front of that quote
};
ShellLine typed_shell_line(const std::string& line);

/// Without control characters.
std::vector<std::string> without_unshowable(std::vector<std::string> candidates);

/// Bash executes what it finds in a candidate: special characters get a backslash; behind an open quote,
/// where that does not help, such candidates are left out. Bash replaces only what follows that quote, or the
/// last `=` or `:`; candidates are those parts.
std::vector<std::string> for_bash(std::vector<std::string> candidates, const ShellLine& typed);

/// `asipctl __complete SHELL LINE`: candidates, one a line. Silent, and kExitOk, without a bus.
int run_complete(const std::vector<std::string>& arguments, CommandLine& line, Environment& environment);

}  // namespace asip::cli
