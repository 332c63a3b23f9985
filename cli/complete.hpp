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
/// next, which may be empty. A quote that is still open is taken as closed.
struct TypedLine {
    std::vector<std::string> words;
    std::string start;
};
TypedLine typed_line(const std::string& line);

/// Bash replaces only what follows the last `=` or `:` of the word; its candidates are those parts.
std::vector<std::string> for_bash(std::vector<std::string> candidates, const std::string& start);

/// `asipctl __complete SHELL LINE`, which the scripts call: candidates, one a line. Silent, and kExitOk, when
/// there is no bus.
int run_complete(const std::vector<std::string>& arguments, CommandLine& line, Environment& environment);

}  // namespace asip::cli
