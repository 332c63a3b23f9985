// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "sim/world/track.hpp"

namespace asip::sim::world {

/// One time around.
struct Lap {
    double seconds = 0;
    double rms_mm = 0;  ///< root of the mean square of the distance from the middle of the line
    double max_mm = 0;  ///< the largest distance
};

/// Follows something around a track: counts laps in either direction and notices when it has left the line.
/// Leaving it, or being put elsewhere, begins a new lap there.
class LapCounter {
  public:
    /// `off_mm`: further than this from the middle of the line is off the track. The track outlives it.
    LapCounter(const Track& track, double off_mm) : track_(track), off_mm_(off_mm) {}

    struct Seen {
        std::optional<Lap> lap;  ///< complete now
        bool left = false;       ///< went off just now
        bool returned = false;   ///< came back just now
    };
    /// It is at `point` now; `seconds` have passed since the last call.
    Seen step(Point point, double seconds);
    /// It was put elsewhere.
    void restart();

    bool on_track() const { return on_track_; }
    unsigned laps() const { return laps_; }
    const Lap& last_lap() const { return last_; }
    double offset_mm() const { return offset_; }

  private:
    const Track& track_;
    double off_mm_;
    bool on_track_ = true;
    std::optional<double> along_;
    double way_ = 0;  // along the line since the lap began, backwards negative
    double time_ = 0;
    double squares_ = 0;  // integral of the squared offset
    double max_ = 0;
    double offset_ = 0;
    unsigned laps_ = 0;
    Lap last_;
};

}  // namespace asip::sim::world
