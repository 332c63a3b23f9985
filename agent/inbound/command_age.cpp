// SPDX-License-Identifier: Apache-2.0
#include "agent/inbound/command_age.hpp"

#include <algorithm>
#include <chrono>

#include "asip/bus/request/request_envelope.hpp"

namespace asip::agent {

Arrival CommandAge::sent_at(const mqtt::Message& message, std::string_view reading, Time now) const {
    Arrival arrival{delivery_.arrival(now), clock_.time_of(reading)};
    if (message.expiry_seconds)
        arrival.expires = arrival.received +
                          std::clamp<std::chrono::milliseconds>(std::chrono::seconds(*message.expiry_seconds),
                                                                bus::kMinDeadline, bus::kMaxDeadline);
    return arrival;
}

std::optional<Time> CommandAge::runs(Time now, std::optional<Time> timer_due, unsigned continuations) {
    const auto since = pauses_.runs(now, timer_due, continuations);
    if (since) delivery_.process_paused(now, *since);
    return since;
}

}  // namespace asip::agent
