// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "asip/time.hpp"

namespace asip::catalogue {

/// When each of many slots (small integers) is due, at a constant cost for each change.
/// Time is cut into ticks, each with a list of slots to look at; a slot beyond one turn of the wheel is
/// looked at once a turn. A slot that is moved later stays until the wheel reaches it, so a renewal writes
/// one word; one that is moved earlier is listed anew. No slot comes out before its time.
class DueWheel {
  public:
    static constexpr Duration kTick = std::chrono::milliseconds(128);
    static constexpr std::int64_t kTicks = 4096;

    DueWheel() : buckets_(kTicks) {}

    /// Replaces what was set before. `now` never decreases.
    void set(std::uint32_t slot, Time due, Time now);
    void remove(std::uint32_t slot);
    std::optional<Time> due(std::uint32_t slot) const;

    /// Appends the slots that are due to `out`, earliest first, and takes them out.
    void advance(Time now, std::vector<std::uint32_t>& out);

    /// Not later than the earliest due time, and nearly always within a tick of it; empty: nothing is set.
    std::optional<Time> next() const;

    std::size_t size() const { return size_; }

  private:
    static constexpr std::int64_t kUnset = INT64_MIN;
    struct Entry {
        std::int64_t due = 0;        // nanoseconds of Clock
        std::int64_t tick = kUnset;  // in whose list it counts
    };
    using Bucket = std::vector<std::uint32_t>;

    static std::int64_t tick_of(std::int64_t nanoseconds);
    Bucket& bucket(std::int64_t tick) { return buckets_[static_cast<std::uint64_t>(tick) % kTicks]; }
    const Bucket& bucket(std::int64_t tick) const {
        return buckets_[static_cast<std::uint64_t>(tick) % kTicks];
    }
    void place(std::uint32_t slot);
    void look_at(std::int64_t tick, std::int64_t last, std::int64_t now, std::vector<std::uint32_t>& out);

    std::vector<Entry> entries_;
    std::vector<Bucket> buckets_;
    std::vector<std::uint32_t> later_;
    std::size_t size_ = 0;
    std::int64_t tick_ = INT64_MIN;  // first tick not wholly looked at; INT64_MIN: no time is known yet
};

}  // namespace asip::catalogue
