// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <optional>

#include "asip/time.hpp"

namespace asip::mqtt {

/// Brokers whose host receives nothing: says when no byte was acknowledged for too long. TCP itself repeats
/// ever more rarely, and comes back only as long after a cut as the cut lasted. Pure.
class ReceivesNothing {
  public:
    /// Zero: for ever.
    explicit ReceivesNothing(Duration limit) : limit_(limit) {}

    /// From the kernel, about once a second: whether bytes wait for an acknowledgement, and the time since
    /// the last one. True: the limit is reached.
    bool look(Time now, bool waiting, Duration since_acknowledgement) {
        if (!waiting || limit_ == Duration::zero()) {
            since_.reset();
            return false;
        }
        since_ = since_ ? std::max(*since_, now - since_acknowledgement) : now;
        return now - *since_ >= limit_;
    }

  private:
    std::optional<Time> since_;
    Duration limit_;
};

}  // namespace asip::mqtt
