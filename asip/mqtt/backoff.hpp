#pragma once
#include <chrono>

#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::mqtt {

/// Waiting times between attempts: doubling from `first` up to `most`, each drawn from its upper half so that
/// programs that lost the same broker do not return in step.
class Backoff {
  public:
    Backoff(Duration first, Duration most) : first_(first), most_(most), next_(first) {}

    Duration next(const Random& random);
    void reset() { next_ = first_; }

  private:
    Duration first_;
    Duration most_;
    Duration next_;
};

}  // namespace asip::mqtt
