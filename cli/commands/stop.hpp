// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "cli/environment.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct StopOptions {
    std::vector<std::string> boards;
    SelectorText selector{};
    bool all = false;
    bool once = false;  ///< the board takes commands again
    bool resume = false;
    std::string why{};
    OutputOptions output{Output::kTable, {}};
};

int run_stop(const StopOptions& options, Environment& environment);

}  // namespace asip::cli
