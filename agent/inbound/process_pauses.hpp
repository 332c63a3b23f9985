// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <optional>
#include <utility>

#include "asip/time.hpp"

namespace asip::agent {

/// Detects that the agent did not run: it was stopped and continued (SIGSTOP), or its timer is late (a
/// suspended machine, no processor time). What is read then may have waited as long. Pure.
class ProcessPauses {
  public:
    /// A timer that is later shows a pause.
    static constexpr Duration kLate = std::chrono::milliseconds(500);

    /// Call it before anything else is done. `due`: when its timer was to end; `continuations`: how often the
    /// process went on after a stop. Returns the beginning of a pause.
    std::optional<Time> runs(Time now, std::optional<Time> due, unsigned continuations = 0) {
        const bool continued = std::exchange(continuations_, continuations) != continuations;
        const auto last = std::exchange(last_, now);
        const bool paused = last && (continued || (due && now >= std::max(*due, *last) + kLate));
        return paused ? last : std::nullopt;
    }

  private:
    std::optional<Time> last_;
    unsigned continuations_ = 0;
};

}  // namespace asip::agent
