// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "registry/catalogue_types.hpp"

namespace asip::registry {

/// Milliseconds of the time by which values are kept. It never goes back, whatever the clock says, and stands
/// still while no registry runs.
using Tick = std::int64_t;

/// A stretch in which values were watched without a break: [start, end). `offset` makes a tick a time of day.
struct Stretch {
    Tick start = 0;
    Tick end = 0;
    std::int64_t offset = 0;

    std::int64_t shown(Tick tick) const { return tick + offset; }
    friend bool operator==(const Stretch&, const Stretch&) = default;
};

/// Turns the two clocks into ticks. A stretch begins where ticks and time of day have the same place in the
/// hour, so that minutes and hours begin where people expect them. A clock that is set soon after a start
/// corrects the times of the stretch (small computers have no clock of their own); one that is set later
/// begins another. Pure.
class Timeline {
  public:
    static constexpr std::int64_t kSetBy = 2'000;  ///< ms; a smaller difference is no setting of the clock
    static constexpr Duration kCorrects = std::chrono::minutes(10);

    /// `last`: the end of what is kept; nothing: nothing is.
    Timeline(std::optional<Tick> last, Instant now) { begin(last, now); }

    Tick at(Time time) const;
    /// `now` as the clock says it: it and the ticks may differ by kSetBy. A clock that was set since tick()
    /// has no say.
    Tick by_clock(Instant now) const;
    Stretch stretch(Time now) const { return {start_, at(now), offset_}; }
    /// True: the clock was set so that the stretch ends here, and another one has begun. `now.time` never
    /// decreases.
    bool tick(Instant now);

  private:
    void begin(std::optional<Tick> last, Instant now);
    /// By how much the clock is before the ticks.
    std::int64_t ahead(Instant now) const;

    Tick start_ = 0;
    std::int64_t offset_ = 0;
    Instant began_{};
};

}  // namespace asip::registry
