#include "registry/catalogue/lease_wheel.hpp"

#include <algorithm>

namespace asip::registry {

std::int64_t LeaseWheel::tick_of(std::int64_t nanoseconds) {
    const std::int64_t length = std::chrono::duration_cast<std::chrono::nanoseconds>(kTick).count();
    const std::int64_t quotient = nanoseconds / length;
    return nanoseconds % length < 0 ? quotient - 1 : quotient;
}

void LeaseWheel::set(std::uint32_t slot, Time due, Time now) {
    if (slot >= entries_.size()) entries_.resize(std::max<std::size_t>(slot + 1, entries_.size() * 3 / 2));
    Entry& entry = entries_[slot];
    const auto nanoseconds =
        std::chrono::duration_cast<std::chrono::nanoseconds>(due.time_since_epoch()).count();
    if (size_ == 0) {
        const auto present =
            std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch()).count();
        tick_ = std::max(tick_, tick_of(present));
    }
    if (entry.bucket != kNone) {
        if (nanoseconds >= entry.due) {
            entry.due = nanoseconds;
            return;
        }
        unlink(slot);
    }
    entry.due = nanoseconds;
    link(slot);
}

void LeaseWheel::link(std::uint32_t slot) {
    Entry& entry = entries_[slot];
    // What is already past waits in the tick that advance() looks at next; what is beyond the horizon, in the
    // last.
    const std::int64_t tick = std::clamp(tick_of(entry.due), tick_, tick_ + kTicks - 1);
    entry.bucket = static_cast<std::uint32_t>(static_cast<std::uint64_t>(tick) % kTicks);
    entry.previous = kNone;
    entry.next = heads_[entry.bucket];
    if (entry.next != kNone) entries_[entry.next].previous = slot;
    heads_[entry.bucket] = slot;
    ++size_;
}

void LeaseWheel::unlink(std::uint32_t slot) {
    Entry& entry = entries_[slot];
    if (entry.previous != kNone) {
        entries_[entry.previous].next = entry.next;
    } else {
        heads_[entry.bucket] = entry.next;
    }
    if (entry.next != kNone) entries_[entry.next].previous = entry.previous;
    entry.bucket = kNone;
    --size_;
}

void LeaseWheel::remove(std::uint32_t slot) {
    if (slot < entries_.size() && entries_[slot].bucket != kNone) unlink(slot);
}

std::optional<Time> LeaseWheel::due(std::uint32_t slot) const {
    if (slot >= entries_.size() || entries_[slot].bucket == kNone) return std::nullopt;
    return Time(std::chrono::duration_cast<Duration>(std::chrono::nanoseconds(entries_[slot].due)));
}

void LeaseWheel::advance(Time now, std::vector<std::uint32_t>& out) {
    const auto nanoseconds =
        std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch()).count();
    const std::int64_t last = tick_of(nanoseconds);
    if (size_ == 0 || last < tick_) return;
    const std::size_t before = out.size();
    // After a long pause one turn of the wheel visits every bucket; the ticks in between need no turn each.
    const std::int64_t first = std::max(tick_, last - static_cast<std::int64_t>(kTicks) + 1);
    std::vector<std::uint32_t> later;
    for (std::int64_t tick = first; tick <= last && size_ > 0; ++tick) {
        std::uint32_t slot = heads_[static_cast<std::uint64_t>(tick) % kTicks];
        while (slot != kNone) {
            const std::uint32_t next = entries_[slot].next;
            if (entries_[slot].due <= nanoseconds) {
                unlink(slot);
                out.push_back(slot);
            } else if (tick < last || tick_of(entries_[slot].due) > last) {
                unlink(slot);
                later.push_back(slot);
            }
            slot = next;
        }
    }
    tick_ = last;
    for (const std::uint32_t slot : later)
        link(slot);
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(before), out.end(),
              [this](std::uint32_t a, std::uint32_t b) {
                  return entries_[a].due != entries_[b].due ? entries_[a].due < entries_[b].due : a < b;
              });
}

std::optional<Time> LeaseWheel::next() const {
    if (size_ == 0) return std::nullopt;
    for (std::int64_t tick = tick_; tick < tick_ + kTicks; ++tick) {
        std::uint32_t slot = heads_[static_cast<std::uint64_t>(tick) % kTicks];
        if (slot == kNone) continue;
        std::int64_t earliest = INT64_MAX;
        for (; slot != kNone; slot = entries_[slot].next)
            earliest = std::min(earliest, entries_[slot].due);
        const std::int64_t length = std::chrono::duration_cast<std::chrono::nanoseconds>(kTick).count();
        // A bucket may hold slots moved far ahead: then the tick after it is soon enough.
        const std::int64_t nanoseconds = std::min(earliest, (tick + 1) * length);
        return Time(std::chrono::duration_cast<Duration>(std::chrono::nanoseconds(nanoseconds)));
    }
    return std::nullopt;
}

std::size_t LeaseWheel::bytes() const {
    return entries_.capacity() * sizeof(Entry) + heads_.capacity() * sizeof(std::uint32_t);
}

}  // namespace asip::registry
