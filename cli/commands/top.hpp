// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <string>

#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct TopOptions {
    std::string pattern = "*";  ///< of boards
    std::chrono::milliseconds interval{1000};
    std::size_t count = 0;      ///< refreshes; 0: until Ctrl-C
    std::string sort = "name";  ///< rate, age, errors, trip
    bool no_ping = false;
    bool stats = false;  ///< what agents counted, instead of services
    OutputOptions output{Output::kTable, {}};
};

/// `asipctl top`: a table that is drawn anew each interval; on anything but a terminal, one below the other.
int run_top(const TopOptions& options, Environment& environment);

}  // namespace asip::cli
