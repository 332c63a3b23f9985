// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "agent/inbound/arrival.hpp"
#include "agent/inbound/delayed_delivery.hpp"
#include "agent/inbound/process_pauses.hpp"
#include "asip/bus/request/agent_clock.hpp"
#include "asip/mqtt/message.hpp"

namespace asip::agent {

/// Finds out when a command was sent, so that none is executed late, by four signs: the agent's clock in the
/// command, the MQTT expiry, pauses of this process, and checks that show a delayed delivery. Pure.
class CommandAge {
  public:
    explicit CommandAge(const Random& random) : clock_(random) {}

    /// To be called as the message is read. `reading`: of the agent's clock, from the envelope; may be empty.
    Arrival sent_at(const mqtt::Message& message, std::string_view reading, Time now) const;

    /// A reading for answers; senders put it into their commands.
    std::string clock(Time now) const { return clock_.read(now); }

    // --- what it learns from
    /// Call it before anything else is done at `now`. `timer_due`: when the process had asked to be woken;
    /// `continuations`: how often it went on after a stop. Returns the beginning of a pause of the process;
    /// then a check is due.
    std::optional<Time> runs(Time now, std::optional<Time> timer_due, unsigned continuations);
    /// True: the first check is due now.
    bool commanded(Time now, bool qos1) { return delivery_.commanded(now, qos1); }
    /// Nothing that was delayed on the old connection comes over the new one.
    void connection_changed() { delivery_ = {}; }
    /// Checks of the connection, see DelayedDelivery.
    std::optional<Time> next_check() const { return delivery_.next_check(); }
    void check_sent(Time now) { delivery_.sent(now); }
    bool check_answered(Time now) { return delivery_.answered(now); }

  private:
    bus::AgentClock clock_;
    ProcessPauses pauses_;
    DelayedDelivery delivery_;
};

}  // namespace asip::agent
