// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

namespace asip::cli {

/// Values measured one by one, and what they look like together.
class Samples {
  public:
    void add(double value) { values_.push_back(value); }
    std::size_t size() const { return values_.size(); }
    bool empty() const { return values_.empty(); }

    /// The smallest value that `percent` (0..100) of all values do not exceed (nearest rank); 0 when there
    /// are none.
    double percentile(double percent) const;
    double minimum() const { return percentile(0); }
    double maximum() const { return percentile(100); }
    double mean() const;

  private:
    std::vector<double> values_;
};

}  // namespace asip::cli
