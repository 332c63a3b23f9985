// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <utility>

#include "asip/time.hpp"

namespace asip::gateway::exports {

/// A state topic: what was published on it, and what waits for its turn. The newest value is always published
/// last. Pure.
class PacedValue {
  public:
    /// What the broker keeps of an earlier time.
    void adopt(std::string text) {
        sent_ = std::move(text);
        sent_at_.reset();
    }
    /// The text to publish at once; nothing: it is there already, or waits().
    bool offer(std::string text, Time now, Duration between, bool room) {
        if (text == sent_) {
            waiting_.reset();
            return false;
        }
        waiting_ = std::move(text);
        return take(now, between, room);
    }
    /// Whether what waits may be published now: then it is sent().
    bool take(Time now, Duration between, bool room) {
        if (!waiting_ || !room || (sent_at_ && now - *sent_at_ < between)) return false;
        sent_ = std::move(*waiting_);
        waiting_.reset();
        sent_at_ = now;
        return true;
    }
    bool waits() const { return waiting_.has_value(); }
    /// The broker keeps what it had of an earlier time, and it is known to be another now.
    bool is_outdated() const { return waiting_ && !sent_at_; }
    const std::string& sent() const { return sent_; }

  private:
    std::string sent_;  // empty: nothing
    std::optional<std::string> waiting_;
    std::optional<Time> sent_at_;
};

}  // namespace asip::gateway::exports
