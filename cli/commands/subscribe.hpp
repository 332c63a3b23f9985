#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "cli/context.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct SubscribeOptions {
    std::vector<std::string> targets;
    bool raw = false;       ///< ASIP lines instead of decoded values
    std::size_t count = 0;  ///< end after so many; 0: no limit
    std::string seconds;    ///< end after this duration; empty: no limit
    std::string format;     ///< template; empty: by `output`
    bool time = false;
    bool age = false;
    Output output = Output::kText;
};

/// `asipctl subscribe`: what boards report, as it comes. kExitNoAnswer when the time is over and fewer than
/// `count` (at least one) came.
int run_subscribe(const SubscribeOptions& options, Context& context);

}  // namespace asip::cli
