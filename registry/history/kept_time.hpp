// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>

#include "registry/catalogue_types.hpp"

namespace asip::registry {

/// Time by which the age of what a history keeps is measured: milliseconds since the file was made. It does
/// not go back, and no setting of the clock moves it. It goes on by the monotonic clock, also while no
/// registry runs, as long as the machine does. For the time that the machine was off there is only the time
/// of day: that counts once the clock has run for a day without being set, on both sides of the gap. In doubt
/// it does not count, and rows are kept for longer. Pure.
class KeptTime {
  public:
    using Milliseconds = std::chrono::milliseconds;

    /// A clock whose relation to the monotonic one has changed by more than this was set.
    static constexpr Milliseconds kSet = std::chrono::minutes(1);
    static constexpr Duration kProven = std::chrono::hours(24);

    /// One moment, as the file keeps it.
    struct Mark {
        Milliseconds kept{};
        text::WallTime wall{};
        bool proven = false;  ///< `wall` had run for a day without being set
        std::string boot{};   ///< run of the machine, to which `monotonic` belongs; empty: unknown
        Milliseconds monotonic{};

        bool operator==(const Mark&) const = default;
    };

    /// `boot`: of the machine's present run.
    KeptTime(std::string boot, Instant now);

    /// Goes on from what a file keeps. To be called once; times given before count from 0.
    void load(const std::optional<Mark>& mark, Instant now);
    /// To be called at least once a minute. `now.time` never decreases.
    void tick(Instant now);

    Milliseconds at(Time time) const;
    Mark mark(Instant now) const;

  private:
    bool proven(Time now) const { return now - unset_since_ >= kProven; }

    std::string boot_;
    Time start_;
    Milliseconds base_{1};       // kept time at start_
    Milliseconds difference_{};  // of the time of day from the monotonic one
    Time unset_since_;           // at the least
    std::optional<Mark> before_the_gap_;
};

/// The present run of the machine; empty where the system does not say.
std::string boot_id();

}  // namespace asip::registry
