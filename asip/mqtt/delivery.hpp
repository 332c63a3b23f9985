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
    /// Where there are fewer, the last one says little of how the broker is now. In doubt there are as many.
    static constexpr Duration kOften = std::chrono::seconds(5);
    /// In these it is lost though others come.
    static constexpr int kPatiences = 10;

    /// `every`: time between two messages; zero: none is sent.
    explicit Delivery(Duration every) : every_(every) {}

    /// A new connection.
    void restart(Time now) {
        sent_.reset();
        came_.reset();
        took_until_.reset();
        heard_ = now;
        next_ = now + std::min(every_, kSettling);
    }
    /// `in_doubt`: something else that the broker owes us is late.
    bool due(Time now, bool in_doubt = false) const {
        if (every_ == Duration::zero() || sent_) return false;
        return now >= next_ || (in_doubt && came_ && now >= *came_ + kOften);
    }
    void sent(Time now) { sent_ = published_ = now; }
    /// A message of somebody came.
    void heard(Time now) { heard_ = now; }
    /// Ours came.
    void came(Time now) {
        sent_.reset();
        came_ = now;
        took_until_ = published_;
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
    bool works(Time now) const { return came_ && now - *came_ <= std::min(every_, kOften) + kPatience; }
    /// Whether the broker took what was published on this connection at that time: one of ours that left
    /// behind it came, and brokers read what a client sends in order.
    bool took(Time published) const { return took_until_ && published < *took_until_; }
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
    std::optional<Time> sent_;        // the one under way; later, where we were behind
    Time published_{};                // the last one, truly
    std::optional<Time> came_;        // the newest on this connection
    std::optional<Time> took_until_;  // when that was published
    bool seen_ = false;
};

}  // namespace asip::mqtt
