// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace asip::mqtt {

/// The names of user properties that programs of this bus know. Of a received message the first of each is
/// kept, with a value up to kMaxUserPropertyBytes; the others are dropped.
inline constexpr std::array<std::string_view, 2> kUserProperties{"by", "clock"};
inline constexpr std::size_t kMaxUserPropertyBytes = 256;

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
    /// When received: those of kUserProperties only.
    std::vector<std::pair<std::string, std::string>> user_properties{};

    /// What it takes in memory, in bytes: everything in it.
    std::size_t bytes() const {
        auto sum = topic.size() + payload.size() + response_topic.size() + correlation.size();
        for (const auto& each : user_properties)
            sum += sizeof each + each.first.size() + each.second.size();
        return sum;
    }

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
