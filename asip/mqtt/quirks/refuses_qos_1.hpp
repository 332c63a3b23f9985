// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

namespace asip::mqtt {

/// A broker that refuses QoS 1: which QoS is used in its place. Pure.
class QosLimit {
  public:
    /// The QoS of a message or a will that wants `wanted`.
    int of(int wanted) const { return std::min(wanted, allowed_); }

    /// The broker of this connection allows so much (MQTT 5). True: that is less than was used.
    bool broker_allows(int highest) {
        const int before = of(1);
        allowed_ = highest;
        return of(1) < before;
    }

    /// The QoS of a subscription. Some brokers refuse subscriptions with QoS 1 only, while they cannot store
    /// messages: with QoS 0 commands arrive there nevertheless.
    int of_subscription(int wanted, bool was_refused) const { return was_refused ? 0 : of(wanted); }

  private:
    int allowed_ = 1;
};

}  // namespace asip::mqtt
