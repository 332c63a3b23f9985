// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "registry/values/timeline.hpp"

namespace asip::registry {

/// How finely values are kept.
enum class Level { kChanges, kMinutes, kHours };
inline constexpr std::size_t kLevels = 3;
/// "changes", "minutes", "hours"
constexpr std::string_view to_text(Level level) {
    return std::array<std::string_view, kLevels>{"changes", "minutes",
                                                 "hours"}[static_cast<std::size_t>(level)];
}

inline constexpr Tick kSecondTicks = 1000, kMinuteTicks = 60 * kSecondTicks, kHourTicks = 60 * kMinuteTicks,
                      kDayTicks = 24 * kHourTicks;
/// The length of a bucket of each level, and of a part: what is kept is dropped part by part. At the
/// beginning of each part every value is written again, so that no part needs those before.
inline constexpr std::array<Tick, kLevels> kBucketTicks{0, kMinuteTicks, kHourTicks};
inline constexpr std::array<Tick, kLevels> kPartTicks{6 * kHourTicks, 3 * kDayTicks, 90 * kDayTicks};
constexpr Tick bucket_ticks(Level level) {
    return kBucketTicks[static_cast<std::size_t>(level)];
}
constexpr Tick part_ticks(Level level) {
    return kPartTicks[static_cast<std::size_t>(level)];
}

/// No value: it is not known, or the board is not there.
inline constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

struct Change {
    Tick at = 0;
    double value = kGap;  ///< from `at` on
};

/// What a value was from `at` to the end of the minute or hour. Where no bucket follows, `last` goes on.
struct Bucket {
    Tick at = 0;
    double min = kGap, mean = kGap, max = kGap;
    double last = kGap;
    Tick known = 0;  ///< for so long it was known
};

/// A property on the bus.
struct PropertyKey {
    std::string board;
    std::string property;
    friend auto operator<=>(const PropertyKey&, const PropertyKey&) = default;
};
struct PropertyHash {
    std::size_t operator()(const PropertyKey& key) const {
        return std::hash<std::string>()(key.board) * 31 + std::hash<std::string>()(key.property);
    }
};

/// What is to be written of one property.
struct PropertyRows {
    PropertyKey key;
    std::vector<Change> changes;
    std::vector<Bucket> minutes, hours;  ///< one may be written again, until it is over
};

struct ValueRows {
    std::vector<Stretch> stretches;  ///< the last one goes on
    std::vector<PropertyRows> properties;
    std::size_t changes = 0;
};

/// Folds a value into the buckets of one level. Only those in which something changed are given out. Pure.
class Folding {
  public:
    explicit Folding(Level level) : length_(bucket_ticks(level)), part_(part_ticks(level)) {}

    /// A stretch begins: nothing is known.
    void begin(Tick at);
    /// The value was `value` from the time of the call before to `to`.
    void hold(double value, Tick to, std::vector<Bucket>& out);
    /// It is `value` from now on.
    void change(double value);
    /// The bucket that is not over yet, where something is new in it since it was given out.
    std::optional<Bucket> unfinished(double value);

  private:
    Bucket bucket(double last) const;
    void start(Tick at, bool changed);

    Tick length_, part_;
    Tick begin_ = 0, at_ = 0;
    bool changed_ = false, fresh_ = false;
    double min_ = kGap, max_ = kGap, sum_ = 0;
    Tick known_ = 0;
};

/// Turns the values of properties and the time into rows. Pure: the caller writes what take() returns.
class Recorder {
  public:
    struct Options {
        std::size_t max_properties = 10'000;
        std::size_t max_of_board = 512;       ///< those that were dropped since take() among them
        std::size_t max_waiting = 1'000'000;  ///< changes; beyond, there is a gap
    };
    Recorder() : Recorder(Options{}) {}
    explicit Recorder(Options options) : options_(options) {}

    /// Values are kept from now on; `last` as for Timeline.
    void begin(std::optional<Tick> last, Instant now);
    bool running() const { return timeline_.has_value(); }

    /// It is `value` from now on, or kGap. Before begin() this is only remembered.
    void set(const PropertyKey& key, double value, Instant now);
    /// It is kept no longer.
    void drop(const PropertyKey& key, Instant now);

    /// Looks at the clock. Call a few times a second.
    void tick(Instant now) {
        if (timeline_) check_clock(now);
    }
    /// What is to be written since the call before. A gap that a full memory made ends with it.
    ValueRows take(Instant now);
    /// The present stretch, as far as it was taken.
    Stretch present(Instant now) const;
    bool waits() const { return waiting_ > 0; }
    /// Changes that had no room.
    std::size_t dropped() const { return dropped_; }
    /// Properties for which there is no room.
    std::size_t refused() const { return refused_; }
    std::size_t size() const { return entries_.size(); }

  private:
    struct Entry {
        double value = kGap;
        Tick at = 0;  // held until
        bool gone = false;
        Tick hours_given = 0;
        Folding minutes{Level::kMinutes}, hours{Level::kHours};
        PropertyRows rows;
    };
    void begin_stretch(Tick start);
    void end_stretch(Tick end);
    void hold(Entry& entry, Tick to);
    void put(Entry& entry, double value, Tick at);
    void give(Entry& entry, ValueRows& rows);
    void check_clock(Instant now);

    Options options_;
    std::optional<Timeline> timeline_;
    std::unordered_map<PropertyKey, Entry, PropertyHash> entries_;  // looked up for each change
    std::map<std::string, std::size_t> of_board_;                   // entries
    std::vector<Stretch> ended_;
    Tick start_ = 0;   // of the present stretch
    Tick oldest_ = 0;  // of the changes that wait
    std::size_t waiting_ = 0;
    std::size_t dropped_ = 0, refused_ = 0;
    bool full_ = false;
};

}  // namespace asip::registry
