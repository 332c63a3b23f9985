// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <optional>

#include "asip/time.hpp"

namespace asip::mqtt {

/// A broker whose host receives nothing: says when it has acknowledged no byte for too long. TCP itself sends
/// again ever more rarely, and comes back only as long after a cut of the network as the cut lasted. Pure.
class ReceivesNothing {
  public:
    /// For how long a host may acknowledge nothing; zero: for ever.
    explicit ReceivesNothing(Duration limit) : limit_(limit) {}

    /// What the kernel says, about once a second: whether bytes wait for an acknowledgement, and how long ago
    /// the last acknowledgement of any byte came. True: the limit is reached.
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
