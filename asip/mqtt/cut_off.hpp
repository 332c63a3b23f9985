// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/mqtt/client.hpp"

namespace asip::mqtt {

/// Notices that a broker cuts the connection off because of what is published: Mosquitto 2.0.11 does so to
/// every message that its access rules deny, and gives no reason. Pure.
class CutOff {
  public:
    static constexpr Duration kSoon = std::chrono::seconds(1);    ///< after a message
    static constexpr Duration kShort = std::chrono::seconds(10);  ///< a connection that is
    static constexpr unsigned kTimes = 3;                         ///< in a row

    void sent(Time now) { sent_ = now; }

    /// An established connection ended, which had been up for so long. From the third time on, `failure` says
    /// what to check, and after_sending counts.
    void ended(ConnectionFailure& failure, Duration was_up, const std::string& user, Time now) {
        const bool closed = failure.kind == ConnectionFailure::Kind::kClosed && failure.code == 0;
        const bool cut_off = closed && was_up < kShort && sent_ != Time{} && now - sent_ < kSoon;
        failure.after_sending = cut_off ? ++times_ : times_ = 0;
        sent_ = {};
        if (times_ < kTimes) return;
        const std::string who = user.empty() ? "a connection without user" : "user \"" + user + "\"";
        failure.text += " right after it was sent messages, " + std::to_string(times_) +
                        " times in a row, as some brokers do where access rules deny one: may " + who +
                        " write them? Whoever keeps the broker can tell (asipctl secure check) and allow it";
    }

  private:
    Time sent_{};
    unsigned times_ = 0;
};

}  // namespace asip::mqtt
