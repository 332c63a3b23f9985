// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <optional>

#include "asip/time.hpp"

namespace asip::mqtt {

/// Notices that a node of a cluster takes what is published and granted subscriptions, and delivers nothing
/// any more: RabbitMQ was seen to do so after its nodes had been cut off from each other, until its clients
/// connected anew. A client sends itself a message now and then, and leaves a broker that does not deliver
/// it. Pure.
class Delivery {
  public:
    /// A message that did not come after this long is lost, unless others come: it may be behind them.
    static constexpr Duration kPatience = std::chrono::seconds(3);
    /// Grows to this, doubling, while broker after broker delivers nothing.
    static constexpr Duration kMostPatience = std::chrono::seconds(48);
    /// Before the first one on a connection.
    static constexpr Duration kSettling = std::chrono::seconds(1);
    /// In these it is lost though others come.
    static constexpr int kPatiences = 10;

    /// `every`: time between two messages; zero: none is sent.
    explicit Delivery(Duration every) : every_(every) {}

    /// A new connection.
    void restart(Time now) {
        sent_.reset();
        came_.reset();
        heard_ = now;
        next_ = now + std::min(every_, kSettling);
    }
    bool due(Time now) const { return every_ > Duration::zero() && !sent_ && now >= next_; }
    void sent(Time now) { sent_ = now; }
    /// A message of somebody came.
    void heard(Time now) { heard_ = now; }
    /// Ours came.
    void came(Time now) {
        sent_.reset();
        came_ = now;
        seen_ = true;
        next_ = now + every_;
        patience_ = kPatience;
    }
    /// The client has not read yet what the broker sent, which it may be among.
    void behind(Time now) {
        heard_ = now;
        if (sent_) sent_ = now;
    }
    /// Whether to leave this broker. Never before one came: access rules may deny it.
    bool lost(Time now) const {
        return seen_ && sent_ && now - *sent_ >= patience_ &&
               (now - heard_ >= patience_ || now - *sent_ >= kPatiences * patience_);
    }
    /// Ours came a moment ago.
    bool works(Time now) const { return came_ && now - *came_ <= every_ + kPatience; }
    /// It is being left for that.
    void leave() { patience_ = std::min(2 * patience_, kMostPatience); }
    /// The broker closed the connection. Where none ever came that may be why: Mosquitto 2.0.11 closes
    /// whoever publishes what its rules deny.
    void closed() {
        if (sent_ && !seen_) every_ = Duration::zero();
    }

  private:
    Duration every_;
    Duration patience_ = kPatience;
    Time next_{};
    Time heard_{};
    std::optional<Time> sent_;
    std::optional<Time> came_;  // the newest on this connection
    bool seen_ = false;
};

}  // namespace asip::mqtt
