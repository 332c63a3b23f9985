// SPDX-License-Identifier: Apache-2.0
#include "agent/counts/histogram.hpp"

#include <algorithm>

namespace asip::agent {

void Histogram::add(Duration took) {
    const double seconds = std::chrono::duration<double>(took).count();
    const auto bucket = std::lower_bound(kBounds.begin(), kBounds.end(), seconds) - kBounds.begin();
    ++counts_[static_cast<std::size_t>(bucket)];
    ++count_;
    sum_ += seconds;
}

std::optional<double> Histogram::quantile(double part) const {
    if (count_ == 0) return std::nullopt;
    const double wanted = part * static_cast<double>(count_);
    double below = 0;
    for (std::size_t i = 0; i < kBounds.size(); ++i) {
        const auto here = static_cast<double>(counts_[i]);
        if (here > 0 && below + here >= wanted) {
            const double from = i == 0 ? 0 : kBounds[i - 1];
            return from + (kBounds[i] - from) * (wanted - below) / here;
        }
        below += here;
    }
    return kBounds.back();
}

}  // namespace asip::agent
