// SPDX-License-Identifier: Apache-2.0
#include "cli/text/samples.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace asip::cli {

double Samples::percentile(double percent) const {
    if (values_.empty()) return 0;
    auto sorted = values_;
    const auto rank = std::ceil(percent / 100 * static_cast<double>(sorted.size()));
    const auto index =
        static_cast<std::ptrdiff_t>(std::clamp(rank, 1.0, static_cast<double>(sorted.size())) - 1);
    std::nth_element(sorted.begin(), sorted.begin() + index, sorted.end());
    return sorted[static_cast<std::size_t>(index)];
}

double Samples::mean() const {
    if (values_.empty()) return 0;
    return std::accumulate(values_.begin(), values_.end(), 0.0) / static_cast<double>(values_.size());
}

}  // namespace asip::cli
