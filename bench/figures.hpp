// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace asip::bench {

using Milliseconds = std::chrono::duration<double, std::milli>;

struct Latency {
    double p50 = 0, p99 = 0;
};

inline Latency summary(std::vector<double> samples) {
    std::sort(samples.begin(), samples.end());
    if (samples.empty()) throw std::runtime_error("nothing was measured");
    return {samples[samples.size() / 2], samples[samples.size() * 99 / 100]};
}

inline double median(std::vector<double> samples) {
    return summary(std::move(samples)).p50;
}

/// One line of a table: what was measured beside what it must be and aims at.
inline void row(const std::string& what, double value, const char* unit, double must, double aim,
                bool more_is_better = false) {
    const bool good = more_is_better ? value >= must : value <= must;
    std::printf("%-72s %9.2f %-8s must %8.2f  aim %8.2f  %s\n", what.c_str(), value, unit, must, aim,
                good ? "ok" : "MISSED");
}

}  // namespace asip::bench
