// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <set>
#include <utility>

#include "asip/link/byte_stream.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// When a person is told that the board cannot be reached: each kind of failure once, then once a minute. The
/// outage is over when the board is heard: some ports open and close again with nothing behind them. Pure.
class PortOutage {
  public:
    static constexpr Duration kRemindEvery = std::chrono::minutes(1);

    void opened() { attempts_ = kLater; }
    /// The failed attempt is the first of all. Ask once for each failure, before failed().
    bool first_attempt() { return std::exchange(attempts_, kLater) == kFirst; }
    /// True: report it.
    bool failed(link::StreamError::Kind kind, Time now) {
        const bool is_new = kinds_.insert(kind).second;
        if (!is_new && last_logged_ && now < *last_logged_ + kRemindEvery) return false;
        last_logged_ = now;
        return true;
    }
    /// Bytes came. True: report that the outage is over.
    bool heard() {
        kinds_.clear();
        return std::exchange(last_logged_, std::nullopt).has_value();
    }

  private:
    enum Attempts { kFirst, kLater };

    Attempts attempts_ = kFirst;
    std::set<link::StreamError::Kind> kinds_;
    std::optional<Time> last_logged_;
};

}  // namespace asip::agent
