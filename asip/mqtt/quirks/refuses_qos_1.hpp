// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

namespace asip::mqtt {

/// Brokers that refuse QoS 1: the QoS in its place. Pure.
class QosLimit {
  public:
    /// For a message or a will.
    int of(int wanted) const { return std::min(wanted, allowed_); }

    /// From CONNACK (MQTT 5). True: that is less than was used.
    bool broker_allows(int highest) {
        const int before = of(1);
        allowed_ = highest;
        return of(1) < before;
    }

    /// Some brokers refuse only subscriptions of QoS 1 while they cannot store messages: with QoS 0 commands
    /// arrive.
    int of_subscription(int wanted, bool was_refused) const { return was_refused ? 0 : of(wanted); }

  private:
    int allowed_ = 1;
};

}  // namespace asip::mqtt
