// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <vector>

namespace asip::gateway::metrics {

/// How long commands took, in seconds. A bucket counts all up to its bound, as Prometheus wants it; count()
/// is all of them.
class CommandTimes {
  public:
    /// Commands take milliseconds, up to their deadline of 5 s.
    static constexpr std::array<double, 12> kSeconds{0.001, 0.0025, 0.005, 0.01, 0.025, 0.05,
                                                     0.1,   0.25,   0.5,   1,    2.5,   5};
    void add(double seconds) {
        for (std::size_t i = 0; i < kSeconds.size(); ++i)
            buckets_[i] += seconds <= kSeconds[i] ? 1 : 0;
        count_ += 1;
        sum_ += seconds;
    }
    static std::vector<double> bounds() { return {kSeconds.begin(), kSeconds.end()}; }
    std::vector<double> buckets() const { return {buckets_.begin(), buckets_.end()}; }
    double count() const { return count_; }
    double sum() const { return sum_; }

  private:
    std::array<double, kSeconds.size()> buckets_{};
    double count_ = 0;
    double sum_ = 0;
};

}  // namespace asip::gateway::metrics
