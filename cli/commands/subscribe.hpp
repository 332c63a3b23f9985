#pragma once
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cli/context.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct SubscribeOptions {
    std::vector<std::string> targets;
    bool raw = false;                                  ///< ASIP lines instead of decoded values
    std::size_t count = 0;                             ///< end after so many; 0: no limit
    std::optional<std::chrono::milliseconds> limit{};  ///< end after this time
    bool time = false;
    bool age = false;
    OutputOptions output{};
};

/// `asipctl subscribe`: what boards report, as it comes. kExitNoAnswer when the time is over and fewer than
/// `count` (at least one) came.
int run_subscribe(const SubscribeOptions& options, Context& context);

}  // namespace asip::cli
