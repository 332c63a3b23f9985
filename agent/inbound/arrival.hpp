// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>
#include <optional>

#include "asip/session/board_session.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// How old a request is: what CommandAge found out when the request was read. Found out once: the time that a
/// request waits inside the agent after that is known.
struct Arrival {
    Time received{};                ///< the earliest time at which it can have been sent, by its delivery
    std::optional<Time> told{};     ///< when it was sent, by the agent's clock, as its sender tells
    std::optional<Time> expires{};  ///< the end of its MQTT expiry

    /// The earliest time at which it can have been sent, by all that is known.
    Time sent() const { return told ? std::min(*told, received) : received; }

    /// By when it must be answered. `wanted`: the deadline that its sender gives, counted from sent().
    Time deadline(std::optional<Duration> wanted) const {
        if (!expires) return sent() + wanted.value_or(session::kDefaultDeadline);
        // Brokers count expiries in seconds and may cut off one.
        return wanted ? std::min<Time>(sent() + *wanted, *expires + std::chrono::seconds(1)) : *expires;
    }
};

}  // namespace asip::agent
