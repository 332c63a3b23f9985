// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "asip/time.hpp"

namespace asip::agent {

/// Bounds what is told of a flood: so much at once, then so much a second; the rest is counted. Pure.
class Allowance {
  public:
    Allowance(double burst, double per_second) : burst_(burst), per_second_(per_second), left_(burst) {}

    bool take(Time now) {
        if (last_)
            left_ =
                std::min(burst_, left_ + per_second_ * std::chrono::duration<double>(now - *last_).count());
        last_ = now;
        if (left_ < 1) {
            ++dropped_;
            return false;
        }
        left_ -= 1;
        return true;
    }
    /// Since the last call.
    std::uint64_t take_dropped() { return std::exchange(dropped_, 0u); }

  private:
    double burst_, per_second_, left_;
    std::optional<Time> last_;
    std::uint64_t dropped_ = 0;
};

}  // namespace asip::agent
