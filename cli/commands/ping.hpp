#pragma once
#include <cstddef>
#include <string>

#include "cli/context.hpp"
#include "cli/output.hpp"
#include "cli/text/samples.hpp"

namespace asip::cli {

struct PingOptions {
    std::string board;
    std::size_t count = 0;  ///< 0: until Ctrl-C
    std::string interval = "1s";
    bool quiet = false;
    Output output = Output::kText;
};

/// `asipctl ping`: the time a request takes to the board and back. kExitNoAnswer when no answer came at all.
int run_ping(const PingOptions& options, Context& context);

/// What stands below the lines. Pure.
struct PingSummary {
    std::string board;
    std::size_t sent = 0;
    std::size_t failed = 0;  ///< answered, but not by the board
    Samples milliseconds{};

    double loss_percent() const;
    std::string text() const;
    std::string json() const;
};

}  // namespace asip::cli
