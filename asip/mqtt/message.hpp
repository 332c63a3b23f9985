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

/// User properties of this bus. The first of each is kept, up to kMaxUserPropertyBytes; others are dropped.
inline constexpr std::array<std::string_view, 2> kUserProperties{"by", "clock"};
inline constexpr std::size_t kMaxUserPropertyBytes = 256;

/// Members from `response_topic` on travel as MQTT 5 properties, and are left out on a 3.1.1 connection.
struct Message {
    std::string topic{};
    std::string payload{};  ///< any bytes
    int qos = 0;            ///< 0 or 1; this bus does not use 2
    bool retain = false;    ///< when received: it was stored before we subscribed (so on 3.1.1 and 5 alike)

    std::string response_topic{};  ///< where an answer is wanted; empty: nowhere
    std::string correlation{};     ///< correlation data, any bytes
    /// Neither sender nor broker delivers it later. When received: what is left.
    std::optional<std::uint32_t> expiry_seconds{};
    /// When received: only kUserProperties.
    std::vector<std::pair<std::string, std::string>> user_properties{};

    /// In memory.
    std::size_t bytes() const {
        auto sum = topic.size() + payload.size() + response_topic.size() + correlation.size();
        for (const auto& each : user_properties)
            sum += sizeof each + each.first.size() + each.second.size();
        return sum;
    }

    /// Rounded up to seconds, at least one.
    void expire_after(std::chrono::nanoseconds time) {
        const auto seconds = std::chrono::ceil<std::chrono::seconds>(time).count();
        expiry_seconds = static_cast<std::uint32_t>(std::max<std::int64_t>(seconds, 1));
    }
};

/// What a full queue drops first, and what does not wait in it.
enum class Priority {
    kContext,       ///< what a board reports: the oldest is dropped
    kReply,         ///< answers to commands: not dropped; refused only when the queue is twice as full
    kAnnouncement,  ///< descriptions and states of boards: the same
    kUrgent,  ///< leaves ahead of all others: a stop and its answer; refused only at three times as full
};

}  // namespace asip::mqtt
