// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>

#include "asip/bus/registry/answer.hpp"

namespace asip::bus {

/// For how long the value was known until `to`: of several registries, each of which keeps values for itself,
/// the answer counts for which this is the longest.
inline std::chrono::milliseconds known_time(const Answer& answer, text::WallTime to) {
    std::chrono::milliseconds known{};
    for (std::size_t i = 0; i < answer.values.size(); ++i) {
        const auto end = i + 1 < answer.values.size() ? answer.values[i + 1].at : to;
        if (answer.values[i].known && end > answer.values[i].at) known += end - answer.values[i].at;
    }
    return known;
}

}  // namespace asip::bus
