// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/environment.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"
#include "cli/text/samples.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {

struct PingOptions {
    std::string board;
    std::optional<std::size_t> count{};  ///< 0: until Ctrl-C; none: 0 on a terminal, else kPingsInScripts
    std::chrono::milliseconds interval{1000};
    bool quiet = false;
    SelectorText selector{};
    OutputOptions output{};
};

/// Where no terminal can send Ctrl-C.
inline constexpr std::size_t kPingsInScripts = 5;

/// The time of a request to the board and back. kExitNoAnswer: no answer came at all.
int run_ping(const PingOptions& options, Environment& environment);

/// Below the lines. Pure.
struct PingSummary {
    std::string board;
    std::size_t sent = 0;
    std::size_t failed = 0;  ///< answered, but not by the board
    Samples milliseconds{};

    double loss_percent() const;
    std::string text() const;
    nlohmann::json json() const;
    std::vector<Cell> cells() const;  ///< a row of the table of several boards
};

}  // namespace asip::cli
