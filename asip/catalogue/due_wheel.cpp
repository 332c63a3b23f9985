// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/due_wheel.hpp"

#include <algorithm>

namespace asip::catalogue {
namespace {

std::int64_t nanoseconds_of(Time time) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}
Time time_of(std::int64_t nanoseconds) {
    return Time(std::chrono::duration_cast<Duration>(std::chrono::nanoseconds(nanoseconds)));
}
constexpr std::int64_t kTickNanoseconds =
    std::chrono::duration_cast<std::chrono::nanoseconds>(DueWheel::kTick).count();

}  // namespace

std::int64_t DueWheel::tick_of(std::int64_t nanoseconds) {
    const std::int64_t quotient = nanoseconds / kTickNanoseconds;
    return nanoseconds % kTickNanoseconds < 0 ? quotient - 1 : quotient;
}

void DueWheel::set(std::uint32_t slot, Time due, Time now) {
    if (slot >= entries_.size()) entries_.resize(std::max<std::size_t>(slot + 1, entries_.size() * 3 / 2));
    if (size_ == 0) tick_ = std::max(tick_, tick_of(nanoseconds_of(now)));
    Entry& entry = entries_[slot];
    entry.due = nanoseconds_of(due);
    if (entry.tick == kUnset) {
        ++size_;
        place(slot);
    } else if (tick_of(entry.due) < entry.tick) {
        place(slot);
    }
}

void DueWheel::place(std::uint32_t slot) {
    Entry& entry = entries_[slot];
    // What is already past waits in the tick that advance() looks at next; what is beyond the horizon, in the
    // last.
    const std::int64_t tick = std::clamp(tick_of(entry.due), tick_, tick_ + kTicks - 1);
    if (tick == entry.tick) return;
    entry.tick = tick;
    bucket(tick).push_back(slot);
}

void DueWheel::remove(std::uint32_t slot) {
    if (slot >= entries_.size() || entries_[slot].tick == kUnset) return;
    entries_[slot].tick = kUnset;
    --size_;
}

std::optional<Time> DueWheel::due(std::uint32_t slot) const {
    if (slot >= entries_.size() || entries_[slot].tick == kUnset) return std::nullopt;
    return time_of(entries_[slot].due);
}

void DueWheel::look_at(std::int64_t tick, std::int64_t last, std::int64_t now,
                       std::vector<std::uint32_t>& out) {
    constexpr std::size_t kAhead = 12;  // entries lie anywhere in memory: ask for them before they are needed
    Bucket& list = bucket(tick);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (i + kAhead < list.size()) __builtin_prefetch(&entries_[list[i + kAhead]]);
        const std::uint32_t slot = list[i];
        Entry& entry = entries_[slot];
        // Listed here once, but moved since; or listed for a later turn of the wheel.
        if (entry.tick == kUnset ||
            static_cast<std::uint64_t>(entry.tick) % kTicks != static_cast<std::uint64_t>(tick) % kTicks) {
            continue;
        }
        if (entry.due <= now) {
            entry.tick = kUnset;
            --size_;
            out.push_back(slot);
        } else if (tick < last || tick_of(entry.due) > last) {
            entry.tick = kUnset;
            later_.push_back(slot);
        } else {
            entry.tick = tick;
            list[kept++] = slot;
        }
    }
    list.resize(kept);
    if (kept == 0 && list.capacity() > 1024) Bucket().swap(list);
}

void DueWheel::advance(Time time, std::vector<std::uint32_t>& out) {
    const std::int64_t now = nanoseconds_of(time);
    const std::int64_t last = tick_of(now);
    if (size_ == 0 || last < tick_) return;
    const std::size_t before = out.size();
    // After a long pause one turn of the wheel visits every bucket; the ticks in between need no turn each.
    for (std::int64_t tick = std::max(tick_, last - kTicks + 1); tick <= last; ++tick)
        look_at(tick, last, now, out);
    tick_ = last;
    for (const std::uint32_t slot : later_)
        place(slot);
    later_.clear();
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(before), out.end(),
              [this](std::uint32_t a, std::uint32_t b) {
                  return entries_[a].due != entries_[b].due ? entries_[a].due < entries_[b].due : a < b;
              });
}

std::optional<Time> DueWheel::next() const {
    if (size_ == 0) return std::nullopt;
    for (std::int64_t tick = tick_; tick < tick_ + kTicks; ++tick) {
        std::int64_t earliest = INT64_MAX;
        for (const std::uint32_t slot : bucket(tick)) {
            if (entries_[slot].tick == tick) earliest = std::min(earliest, entries_[slot].due);
        }
        // A bucket may hold slots moved far ahead: then the tick after it is soon enough.
        if (earliest != INT64_MAX) return time_of(std::min(earliest, (tick + 1) * kTickNanoseconds));
    }
    return time_of(tick_ * kTickNanoseconds);
}

}  // namespace asip::catalogue
