// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

#include "asip/time.hpp"

namespace asip::load {

/// When the next of many is due, at a steady rate. Of what could not be done in time no more than a second is
/// made up for. Pure.
class Pace {
  public:
    /// `per_second`: above 0.
    explicit Pace(double per_second) : per_second_(per_second) {}

    /// From now on time counts.
    void begin(Time now) { since_ = now; }
    /// `now` does not decrease.
    void pass(Time now) {
        const double seconds = std::chrono::duration<double>(now - since_).count();
        due_ = std::min(due_ + seconds * per_second_, std::max(1.0, per_second_));
        since_ = now;
    }
    /// At least one more is to be done now; then call done().
    bool due() const { return due_ >= 1; }
    void done() { due_ -= 1; }

  private:
    double per_second_;
    Time since_{};
    double due_ = 0;
};

}  // namespace asip::load
