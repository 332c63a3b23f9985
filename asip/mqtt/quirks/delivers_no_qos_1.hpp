// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "asip/time.hpp"

namespace asip::mqtt {

/// Brokers that deliver messages of QoS 0 and none of QoS 1. Mosquitto does so for the rest of a connection
/// after 20 messages above Options::max_packet_bytes. The client sends itself a message of QoS 0, then one of
/// QoS 1, and leaves the connection where only the second is missing: a slow broker delays both. Pure.
class StandStill {
  public:
    /// Between two looks; zero: never.
    explicit StandStill(Duration every) : every_(every) {}

    void restart(Time now) {
        step_ = Step::kIdle;
        since_ = now;
    }
    /// The QoS of the message to publish now; none: no message is due.
    std::optional<int> due(Time now) const {
        if (every_ == Duration::zero()) return std::nullopt;
        if (step_ == Step::kIdle && now - since_ >= every_) return 0;
        if (step_ == Step::kFirstCame) return 1;
        return std::nullopt;
    }
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
    /// Bytes wait to be read.
    void behind(Time now) { heard(now); }
    /// Leave this connection.
    bool found(Time now) const { return step_ == Step::kSecondSent && now - since_ >= every_ / 6; }

  private:
    enum class Step { kIdle, kFirstSent, kFirstCame, kSecondSent };

    Duration every_;
    Step step_ = Step::kIdle;
    Time since_{};  // when that step began
};

}  // namespace asip::mqtt
