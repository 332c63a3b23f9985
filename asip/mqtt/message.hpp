// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace asip::mqtt {

/// One message of the bus, to be published or as it arrived. The members from `response_topic` on travel as
/// MQTT 5 properties and are left out, silently, on a 3.1.1 connection.
struct Message {
    std::string topic{};
    std::string payload{};  ///< any bytes
    int qos = 0;            ///< 0 or 1; this bus does not use 2
    bool retain = false;    ///< when received: it was stored before we subscribed (so on 3.1.1 and 5 alike)

    std::string response_topic{};  ///< where an answer is wanted; empty: nowhere
    std::string correlation{};     ///< correlation data, any bytes
    /// For how long it is of use: neither sender nor broker delivers it later. When received: what is left.
    std::optional<std::uint32_t> expiry_seconds{};
    std::vector<std::pair<std::string, std::string>> user_properties{};

    /// It is of use for `time` from now on: rounded up to seconds, at least one.
    void expire_after(std::chrono::nanoseconds time) {
        const auto seconds = std::chrono::ceil<std::chrono::seconds>(time).count();
        expiry_seconds = static_cast<std::uint32_t>(std::max<std::int64_t>(seconds, 1));
    }
};

/// What is dropped first when the outgoing queue is full, and what does not wait in it.
enum class Priority {
    kContext,       ///< what a board reports: the oldest is dropped
    kReply,         ///< answers to commands: not dropped; refused only when the queue is twice as full
    kAnnouncement,  ///< descriptions and states of boards: the same
    kUrgent,  ///< leaves ahead of all others: a stop and its answer; refused only at three times as full
};

}  // namespace asip::mqtt
