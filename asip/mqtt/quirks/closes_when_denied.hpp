// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "asip/mqtt/client.hpp"

namespace asip::mqtt {

/// Brokers that close the connection without a reason when access rules deny a message: tells a person when
/// it repeats. Pure.
class ClosesWhenDenied {
  public:
    static constexpr Duration kSoon = std::chrono::seconds(1);    ///< between the message and the end
    static constexpr Duration kShort = std::chrono::seconds(10);  ///< how long such a connection lasts at
                                                                  ///< most
    static constexpr unsigned kTimes = 3;                         ///< in a row, before it is said

    /// `bytes`: of the payload.
    void sent(Time now, std::size_t bytes = 0) {
        sent_ = now;
        largest_ = std::max(largest_, bytes);
    }

    /// Before the next connection: longer each time, up to a minute. `brokers`: how many the list has.
    Duration pause(std::size_t brokers) const {
        const unsigned often = times_ / static_cast<unsigned>(std::max<std::size_t>(1, brokers));
        if (often < kTimes) return {};
        return std::min<Duration>(std::chrono::minutes(1),
                                  std::chrono::seconds(1) * (1u << std::min(often - kTimes + 1, 6u)));
    }

    /// An established connection ended. From the third time on, `failure` says what to check, and
    /// after_sending counts.
    void ended(ConnectionFailure& failure, Duration was_up, const std::string& user, Time now) {
        const bool closed = failure.kind == ConnectionFailure::Kind::kClosed && failure.code == 0;
        const bool denied = closed && was_up < kShort && sent_ != Time{} && now - sent_ < kSoon;
        failure.after_sending = denied ? ++times_ : times_ = 0;
        sent_ = {};
        const std::size_t largest = std::exchange(largest_, 0u);
        if (times_ < kTimes) return;
        const std::string who = user.empty() ? "a connection without user" : "user \"" + user + "\"";
        failure.text +=
            " right after it was sent messages, " + std::to_string(times_) +
            " times in a row, as some brokers do where access rules deny one: may " + who +
            " write them? The administrator of the broker can tell (asipctl secure check) and allow it";
        if (largest > 0)
            failure.text += ". Or does it take no message of " + std::to_string(largest) +
                            " bytes, the largest of them (Mosquitto: max_packet_size, message_size_limit)?";
    }

  private:
    Time sent_{};
    std::size_t largest_ = 0;
    unsigned times_ = 0;
};

}  // namespace asip::mqtt
