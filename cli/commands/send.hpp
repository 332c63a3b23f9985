// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "cli/environment.hpp"
#include "cli/find/chosen_boards.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct SendOptions {
    std::string target;              ///< may be empty with from_input
    std::vector<std::string> words;  ///< command and arguments
    SelectorText selector{};         ///< to all boards with these labels that the target matches
    std::string raw;                 ///< a request line for the board itself, instead of words
    bool from_input = false;         ///< one command a line of standard input
    bool no_wait = false;            ///< do not wait for answers
    std::size_t in_flight = 16;      ///< commands of standard input that may be unanswered at a time
    std::optional<std::chrono::milliseconds> hold{};    ///< undo it when it is not renewed for so long
    std::optional<std::chrono::milliseconds> during{};  ///< with hold: end after so long; none: at Ctrl-C
    OutputOptions output{};
};

/// `asipctl send`: one command, or those of standard input in order; the status is that of the first that
/// failed. A target with wildcards, or a selector: the same command to many boards.
int run_send(const SendOptions& options, Environment& environment);

}  // namespace asip::cli
