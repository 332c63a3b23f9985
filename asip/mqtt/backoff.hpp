// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::mqtt {

/// Waiting times that double from `first` to `max`, each drawn from its upper half, so that programs that
/// lost the same broker do not return in step.
class Backoff {
  public:
    Backoff(Duration first, Duration max) : first_(first), max_(max), next_(first) {}

    Duration next(const Random& random);
    /// The next wait is `first` again.
    void reset() { next_ = first_; }

  private:
    Duration first_;
    Duration max_;
    Duration next_;
};

}  // namespace asip::mqtt
