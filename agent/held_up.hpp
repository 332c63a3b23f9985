// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <optional>
#include <utility>

#include "asip/time.hpp"

namespace asip::agent {

/// Finds out that the agent did not run for a while: it was stopped and continued (SIGSTOP), or its timer is
/// late (a suspended machine, no processor time). What is read then may have waited for as long, and is not
/// taken for new. Pure.
class HeldUp {
  public:
    /// A timer that is later than this was held up.
    static constexpr Duration kLate = std::chrono::milliseconds(500);
    /// For so long afterwards messages are read that came meanwhile.
    static constexpr Duration kCatchingUp = std::chrono::milliseconds(300);

    /// The agent runs; call it before anything is done. `due`: when its timer was to end; `continuations`:
    /// how often it went on after a stop.
    void runs(Time now, std::optional<Time> due, unsigned continuations = 0) {
        const bool continued = std::exchange(continuations_, continuations) != continuations;
        if (last_ && (continued || (due && now >= std::max(*due, *last_) + kLate))) {
            since_ = *last_;
            until_ = now + kCatchingUp;
        }
        last_ = now;
    }
    /// When a message that is read now may have come, at the earliest.
    Time arrival(Time now) const { return now < until_ ? since_ : now; }

  private:
    std::optional<Time> last_;
    Time since_{};
    Time until_{};
    unsigned continuations_ = 0;
};

}  // namespace asip::agent
