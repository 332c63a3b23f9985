// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tests/truth/presence/starts.hpp"

namespace truth::presence {

struct Counts {
    std::uint64_t histories = 0, actions = 0, comparisons = 0, contests = 0, misses = 0;
    Starts starts;
    Counts& operator+=(const Counts& other) {
        histories += other.histories;
        actions += other.actions;
        comparisons += other.comparisons;
        contests += other.contests;
        misses += other.misses;
        starts += other.starts;
        return *this;
    }
};

struct End {
    Counts counts;
    std::string failure;             ///< empty: each view said what was so
    std::vector<std::string> trace;  ///< what happened, where it was asked for
};

/// A random history of boards, agents, brokers' connections and programs that look at them; from time to
/// time, when all is quiet, each view is compared with what is really so. `watched`: the view whose messages
/// are part of the trace. `recorded`: what bus views got is added to it, see make_recorded_view().
End run_history(std::uint64_t seed, bool with_trace, const std::string& watched = {},
                std::vector<std::string>* recorded = nullptr);

}  // namespace truth::presence
