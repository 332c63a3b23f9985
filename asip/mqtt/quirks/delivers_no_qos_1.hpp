// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "asip/time.hpp"

namespace asip::mqtt {

/// A broker that delivers messages of QoS 0 and none of QoS 1. Mosquitto does so for the rest of a connection
/// after it took 20 messages that are larger than this client takes (Options::max_packet_bytes). The client
/// sends itself a message with QoS 0, and when that came, one with QoS 1. A slow broker delays both; the
/// client leaves the connection only where the second one alone is missing. Pure.
class StandStill {
  public:
    /// `every`: time between two looks; zero: never.
    explicit StandStill(Duration every) : every_(every) {}

    /// A new connection.
    void restart(Time now) {
        step_ = Step::kIdle;
        since_ = now;
    }
    /// The QoS of the message that is to be published now; none: no message is due.
    std::optional<int> due(Time now) const {
        if (every_ == Duration::zero()) return std::nullopt;
        if (step_ == Step::kIdle && now - since_ >= every_) return 0;
        if (step_ == Step::kFirstCame) return 1;
        return std::nullopt;
    }
    /// The message that was due is published.
    void sent(Time now) {
        step_ = step_ == Step::kIdle ? Step::kFirstSent : Step::kSecondSent;
        since_ = now;
    }
    /// A message from ourselves came.
    void came(int qos, Time now) {
        if (qos == 0 && step_ == Step::kFirstSent) step_ = Step::kFirstCame;
        if (qos == 1 && step_ == Step::kSecondSent) restart(now);
    }
    /// Another message of QoS 1 came: ours may be behind it.
    void heard(Time now) {
        if (step_ == Step::kSecondSent) since_ = now;
    }
    /// Bytes from the broker wait to be read.
    void behind(Time now) { heard(now); }
    /// Whether to leave this connection.
    bool found(Time now) const { return step_ == Step::kSecondSent && now - since_ >= every_ / 6; }

  private:
    enum class Step { kIdle, kFirstSent, kFirstCame, kSecondSent };

    Duration every_;
    Step step_ = Step::kIdle;
    Time since_{};  // when that step began
};

}  // namespace asip::mqtt
