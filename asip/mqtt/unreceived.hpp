// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <optional>

#include "asip/time.hpp"

namespace asip::mqtt {

/// Notices that the other host does not receive what a TCP connection sends. TCP sends it again ever more
/// rarely, and so comes back only as long after a cut of the network as the cut was. Pure.
class Unreceived {
  public:
    /// For how long a host may acknowledge nothing; zero: for ever.
    explicit Unreceived(Duration limit) : limit_(limit) {}

    /// What the kernel says, about once a second: whether bytes wait for an acknowledgement, and how long ago
    /// the last one came, of whatever. True: it is over.
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
