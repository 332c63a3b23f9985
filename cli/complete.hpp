// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cli/command_line.hpp"

namespace asip::cli {

/// Where names come from that only the bus, or the service models, know; each is asked only when needed.
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

/// What a shell is asked to offer instead of words.
inline constexpr const char* kOfferFiles = ":files";
inline constexpr const char* kOfferFolders = ":folders";

/// What `start` may become after `words` (without the program's name): sorted words, or kOfferFiles or
/// kOfferFolders alone. Follows from what help shows. Pure but for the sources.
std::vector<std::string> complete(const CLI::App& app, const std::vector<std::string>& words,
                                  const std::string& start, const NameSources& names);

/// A line typed so far, up to the cursor: whole words without the program's name, and the beginning of the
/// next, which may be empty, as bash, zsh and fish read it. A quote that is still open is taken as closed.
struct ShellLine {
    std::vector<std::string> words;
    std::string start;
    char quote = '\0';         ///< that is still open
    std::size_t unquoted = 0;  ///< so many bytes of `start` stand in front of that quote
};
ShellLine typed_shell_line(const std::string& line);

/// The candidates that can stand in a line of a shell and be shown by it: without control characters.
std::vector<std::string> without_unshowable(std::vector<std::string> candidates);

/// As bash is to insert them: it executes what it finds in a candidate. So each character that may mean
/// something to it has a backslash in front; behind an open quote, where a backslash does not help,
/// candidates with such characters are left out. Bash replaces only what follows that quote, or else the last
/// `=` or `:` of the word; the candidates are those parts.
std::vector<std::string> for_bash(std::vector<std::string> candidates, const ShellLine& typed);

/// `asipctl __complete SHELL LINE`, which the scripts call: candidates, one a line. Silent, and kExitOk, when
/// there is no bus.
int run_complete(const std::vector<std::string>& arguments, CommandLine& line, Environment& environment);

}  // namespace asip::cli
