// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "asip/time.hpp"

namespace asip::agent {

/// Notices a board that restarts again and again, as boards with weak power do. Pure.
class Restarts {
  public:
    static constexpr Duration kMinute = std::chrono::minutes(1);
    /// Between two changes of the announced text.
    static constexpr Duration kBetweenTexts = std::chrono::seconds(5);
    /// Within a minute: no chance.
    static constexpr std::size_t kMany = 3;
    static constexpr std::size_t kMax = 1000;

    /// True: this restart has a line of its own in the log; those of a board that does it again and again
    /// share one.
    bool restarted(Time now) {
        forget(now);
        if (times_.size() < kMax) times_.push_back(now);
        if (times_.size() >= kMany && !due_) due_ = log_at_ = now;
        return !many();
    }
    bool many() const { return due_.has_value(); }
    /// True: text() is to be announced, and logged where to_log() says so.
    bool tick(Time now) {
        to_log_ = false;
        if (!due_ || now < *due_) return false;
        forget(now);
        std::string text;
        if (times_.size() >= kMany) {
            due_ = now + kBetweenTexts;
            text = "restarted " + std::to_string(times_.size()) +
                   (times_.size() == kMax ? " times or more" : " times") +
                   " in the last minute: is its power supply strong enough, is a cable loose?";
            to_log_ = now >= log_at_;
            if (to_log_) log_at_ = now + kMinute;
        } else {
            due_.reset();
        }
        const bool changed = text != text_;
        text_ = std::move(text);
        return changed || to_log_;
    }
    bool to_log() const { return to_log_; }
    std::optional<Time> next_deadline() const { return due_; }
    const std::string& text() const { return text_; }

  private:
    void forget(Time now) {
        while (!times_.empty() && times_.front() <= now - kMinute)
            times_.pop_front();
    }

    std::deque<Time> times_;  // of the last minute
    std::optional<Time> due_;
    Time log_at_{};
    bool to_log_ = false;
    std::string text_;
};

}  // namespace asip::agent
