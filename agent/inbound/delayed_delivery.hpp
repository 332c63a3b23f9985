// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <optional>

#include "agent/inbound/process_pauses.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Detects late delivery, by a slow network or a stalled broker, with checks: questions to the broker whose
/// answers come in order with the messages (mqtt::Client::check). Behind a late answer, messages may be as
/// old as the last check that was answered in time.
/// Checks are sent only while the board is commanded, and after a pause of the agent. A new connection begins
/// with a new object. Pure.
class DelayedDelivery {
  public:
    static constexpr Duration kEvery = std::chrono::seconds(1);
    static constexpr Duration kInUse = std::chrono::seconds(60);
    /// An answer after this time is late, unless the usual one takes more than a quarter of that.
    static constexpr Duration kLate = ProcessPauses::kLate;
    static constexpr int kTimesUsual = 4;
    /// After a late answer: the broker reads what its clients sent meanwhile piece by piece.
    static constexpr Duration kCatchingUp = std::chrono::milliseconds(300);
    /// Without an answer for so long it is no stall: a dead connection is given up earlier, so this broker
    /// does not answer checks.
    static constexpr Duration kNoAnswer = std::chrono::seconds(30);
    /// So many messages of QoS 1 are on their way at least (Mosquitto and MQTT 3.1.1); more wait at the
    /// broker, and an answer overtakes them.
    static constexpr unsigned kWindow = 20;
    /// So long it is waited until fewer come between two checks.
    static constexpr Duration kDraining = std::chrono::seconds(5);

    /// A command was received. True: checks begin, the first is due now.
    bool commanded(Time now, bool qos1);
    /// The agent did not run since `since`. A check is due now, or when the check that is under way is
    /// answered.
    void process_paused(Time now, Time since);
    /// When to send a check; none while one has no answer yet.
    std::optional<Time> next_check() const { return sent_ ? std::nullopt : due_; }
    void sent(Time now);
    /// True: the answer is late.
    bool answered(Time now);

    /// When a message that is read now may have been sent, at the earliest.
    Time arrival(Time now) const;

  private:
    Duration limit() const;

    Time in_use_until_{};
    std::optional<Time> due_;   // the next check, or the one that has no answer yet
    std::optional<Time> sent_;  // while it has none
    Time good_{};               // when the last one was sent whose answer was in time
    bool behind_ = false;       // what comes now may have been delayed
    bool worthless_ = false;    // the check that has no answer yet: the answer may have waited for us
    Time drained_by_{};
    unsigned came_ = 0;  // commands of QoS 1 since the check was sent
    std::array<Duration, 5> took_{};
    std::size_t answers_ = 0;
};

}  // namespace asip::agent
