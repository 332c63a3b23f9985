// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tests/truth/ledger.hpp"

namespace truth {

/// How one history ended.
struct HistoryEnd {
    Counts counts;
    std::string failure;             ///< empty: every answer was true
    std::vector<std::string> trace;  ///< if asked for
};

/// Lets one board session, its line, its board and its clients live for some simulated seconds, as drawn from
/// `seed`, and checks every answer. The same seed gives the same history.
HistoryEnd run_history(std::uint64_t seed, bool trace);

}  // namespace truth
