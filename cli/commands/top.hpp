#pragma once
#include <cstddef>
#include <string>

#include "cli/context.hpp"

namespace asip::cli {

struct TopOptions {
    std::string pattern = "*";  ///< of boards
    std::string interval = "1s";
    std::size_t count = 0;  ///< refreshes; 0: until Ctrl-C
    bool ping = true;
};

/// `asipctl top`: a table that is drawn anew each interval; on anything but a terminal, one below the other.
int run_top(const TopOptions& options, Context& context);

}  // namespace asip::cli
