// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

#include "asip/time.hpp"

namespace asip::mqtt {

/// Which QoS is of use with the brokers of a list. NATS stores what comes with QoS 1 at several nodes. While
/// these have no leader, 10 s and more after a node was lost, it answers a subscription after 4 s and refuses
/// it, and closes whoever published something after as long. What has QoS 0 goes on all the time. Pure.
class UsableQos {
  public:
    static constexpr Duration kSlow = std::chrono::seconds(3);

    explicit UsableQos(int highest) : highest_(highest) {}

    /// The one to use for what wants `wanted`.
    int of(int wanted) const { return std::min({wanted, highest_, allowed_}); }

    /// What the broker of this connection allows (MQTT 5), until another one says otherwise. True: that is
    /// less than was used.
    bool broker_allows(int highest) {
        const int before = of(1);
        allowed_ = highest;
        return of(1) < before;
    }

    /// A broker refused a subscription with QoS 1, or closed the connection, after `waited` for it or for an
    /// acknowledgement. True: from now on QoS 0 is used in its place. Not with brokers that know MQTT 5,
    /// which are others.
    bool failed(Duration waited, bool v5) {
        if (v5 || waited < kSlow || highest_ == 0) return false;
        highest_ = 0;
        return true;
    }

  private:
    int highest_;
    int allowed_ = 1;
};

}  // namespace asip::mqtt
