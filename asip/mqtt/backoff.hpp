// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>

#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::mqtt {

/// Waiting times between attempts. They double from `first` up to `max`; each is drawn at random from its
/// upper half, so that programs that lost the same broker do not return in step.
class Backoff {
  public:
    Backoff(Duration first, Duration max) : first_(first), max_(max), next_(first) {}

    /// How long to wait before the next attempt.
    Duration next(const Random& random);
    /// An attempt succeeded: the next wait is `first` again.
    void reset() { next_ = first_; }

  private:
    Duration first_;
    Duration max_;
    Duration next_;
};

}  // namespace asip::mqtt
