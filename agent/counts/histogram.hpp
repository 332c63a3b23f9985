// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "asip/time.hpp"

namespace asip::agent {

/// Durations, counted in fixed buckets.
class Histogram {
  public:
    /// Upper bounds in seconds; one more bucket takes the rest.
    static constexpr std::array<double, 19> kBounds{.0005, .001, .002, .003, .005, .007, .01, .015, .02, .03,
                                                    .05,   .07,  .1,   .2,   .5,   1,    2,   5,    60};
    using Counts = std::array<std::uint64_t, kBounds.size() + 1>;

    void add(Duration took);
    void clear() { *this = Histogram{}; }

    const Counts& counts() const { return counts_; }
    std::uint64_t count() const { return count_; }
    /// In seconds.
    double sum() const { return sum_; }
    /// The seconds that `part` (0 to 1) of them stay below, interpolated within a bucket; none: nothing was
    /// counted.
    std::optional<double> quantile(double part) const;

  private:
    Counts counts_{};
    std::uint64_t count_ = 0;
    double sum_ = 0;
};

}  // namespace asip::agent
