// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct LogOptions {
    std::string pattern = "*";  ///< of boards
    std::size_t count = 0;      ///< end after so many; 0: no limit
    std::optional<std::chrono::milliseconds> limit{};
    OutputOptions output{};
};

int run_logs(const LogOptions& options, Environment& environment);

}  // namespace asip::cli
