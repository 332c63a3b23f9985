// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cli/environment.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct SubscribeOptions {
    std::vector<std::string> targets;
    SelectorText selector{};
    bool raw = false;                                  ///< ASIP lines instead of decoded values
    std::size_t count = 0;                             ///< end after so many; 0: no limit
    std::optional<std::chrono::milliseconds> limit{};  ///< end after this time
    bool time = false;
    bool age = false;
    std::string field{};     ///< only this part of the reports; empty: all
    bool changes = false;    ///< only what says something else than the report before it
    double max_hz = 0;       ///< at most so many a second of each kind of report; 0: all
    bool no_demand = false;  ///< only listen
    OutputOptions output{};
};

/// kExitNoAnswer: the time is over and fewer than `count` (at least one) came.
int run_subscribe(const SubscribeOptions& options, Environment& environment);

}  // namespace asip::cli
