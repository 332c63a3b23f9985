// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>
#include <optional>

#include "asip/session/board_session.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// How old a request was when it was read; how long it waits inside the agent after that is known.
struct Arrival {
    Time received{};                ///< the earliest time at which it can have been sent, by its delivery
    std::optional<Time> told{};     ///< when it was sent, by the agent's clock, as its sender tells
    std::optional<Time> expires{};  ///< the end of its MQTT expiry

    /// The earliest time that all signs allow.
    Time sent() const { return told ? std::min(*told, received) : received; }

    /// `wanted`: the deadline of the sender, counted from sent().
    Time deadline(std::optional<Duration> wanted) const {
        if (!expires) return sent() + wanted.value_or(session::kDefaultDeadline);
        // Brokers count expiries in seconds and may cut off one.
        return wanted ? std::min<Time>(sent() + *wanted, *expires + std::chrono::seconds(1)) : *expires;
    }
};

}  // namespace asip::agent
