// SPDX-License-Identifier: Apache-2.0
#include "bench/load/times.hpp"

#include <algorithm>
#include <cmath>

namespace asip::load {

void Times::add(Duration time) {
    const double micros = std::max(1.0, std::chrono::duration<double, std::micro>(time).count());
    const auto place = static_cast<std::size_t>(std::log2(micros) * double{kPerDoubling});
    ++classes_[std::min(place, kClasses - 1)];
    ++count_;
    longest_ = std::max(longest_, time);
}

double Times::seconds(double share) const {
    const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
    std::uint64_t passed = 0;
    for (std::size_t i = 0; i < kClasses; ++i) {
        passed += classes_[i];
        if (passed > 0 && passed >= wanted)
            return std::min(std::exp2(static_cast<double>(i + 1) / double{kPerDoubling}) / 1e6,
                            longest_seconds());
    }
    return 0;
}

}  // namespace asip::load
