// SPDX-License-Identifier: Apache-2.0
#include "registry/values/recorder.hpp"

#include <algorithm>
#include <utility>

namespace asip::registry {
namespace {

/// An hour that is not over is written again so often, and each minute whenever something is new in it.
constexpr Tick kHourAgain = 5 * kMinuteTicks;
/// Means of larger ones may have no number.
constexpr double kLargest = 1e200;
/// Changes that come quicker are one: the newest is kept. Agents report ten times a second at most.
constexpr Tick kLeast = 50;

constexpr Tick floor_to(Tick tick, Tick length) {
    return tick - tick % length;
}

bool same_value(double a, double b) {
    return a == b || (std::isnan(a) && std::isnan(b));
}

}  // namespace

// --- one level of one property

void Folding::start(Tick at, bool changed) {
    begin_ = at_ = at;
    changed_ = fresh_ = changed;
    min_ = max_ = kGap;
    sum_ = 0;
    known_ = 0;
}

void Folding::begin(Tick at) {
    start(at, false);
}

Bucket Folding::bucket(double last) const {
    const double mean = known_ > 0 ? sum_ / static_cast<double>(known_) : last;
    // A mean of many products may be off in its last digit.
    return {begin_, min_, std::isnan(min_) ? mean : std::clamp(mean, min_, max_), max_, last, known_};
}

void Folding::hold(double value, Tick to, std::vector<Bucket>& out) {
    while (at_ < to) {
        const Tick end = floor_to(at_, length_) + length_;
        const Tick edge = std::min(to, end);
        if (!std::isnan(value)) {
            min_ = std::fmin(min_, value);
            max_ = std::fmax(max_, value);
            sum_ += value * static_cast<double>(edge - at_);
            known_ += edge - at_;
        }
        at_ = edge;
        if (edge < end) return;
        if (changed_) out.push_back(bucket(value));
        // Buckets in which nothing changes are left out, up to where a part begins.
        const Tick part = floor_to(edge, part_) == edge ? edge : floor_to(edge, part_) + part_;
        const Tick next = std::max(edge, std::min(floor_to(to, length_), part));
        start(next, next == part && !std::isnan(value));
        if (changed_) change(value);
    }
}

void Folding::change(double value) {
    changed_ = fresh_ = true;
    min_ = std::fmin(min_, value);
    max_ = std::fmax(max_, value);
}

std::optional<Bucket> Folding::unfinished(double value) {
    if (!std::exchange(fresh_, false)) return std::nullopt;
    return bucket(value);
}

// --- all properties

void Recorder::begin(std::optional<Tick> last, Instant now) {
    timeline_.emplace(last, now);
    begin_stretch(timeline_->at(now.time));
}

void Recorder::begin_stretch(Tick start) {
    start_ = start;
    for (auto& [key, entry] : entries_) {
        entry.at = entry.hours_given = start;
        entry.minutes.begin(start);
        entry.hours.begin(start);
        const double value = std::exchange(entry.value, kGap);
        if (!std::isnan(value)) put(entry, value, start);
    }
}

/// What comes behind has another offset: no bucket and no value goes on.
void Recorder::end_stretch(Tick end) {
    for (auto& [key, entry] : entries_) {
        hold(entry, end);
        for (auto [folding, out] :
             {std::pair(&entry.minutes, &entry.rows.minutes), std::pair(&entry.hours, &entry.rows.hours)})
            if (const auto bucket = folding->unfinished(entry.value)) out->push_back(*bucket);
    }
}

void Recorder::hold(Entry& entry, Tick to) {
    if (to <= entry.at) return;
    constexpr Tick kPart = kPartTicks[0];
    for (Tick part = floor_to(entry.at, kPart) + kPart; part <= to; part += kPart) {
        if (std::isnan(entry.value)) break;
        if (waiting_++ == 0) oldest_ = part;
        entry.rows.changes.push_back({part, entry.value});
    }
    entry.minutes.hold(entry.value, to, entry.rows.minutes);
    entry.hours.hold(entry.value, to, entry.rows.hours);
    entry.at = to;
}

void Recorder::put(Entry& entry, double value, Tick at) {
    hold(entry, at);
    entry.value = value;
    auto& changes = entry.rows.changes;
    // One of the stretch before stays: what is in this one begins in it.
    if (!changes.empty() && changes.back().at >= start_ && at < changes.back().at + kLeast) {
        changes.back().value = value;
    } else {
        if (waiting_++ == 0) oldest_ = at;
        changes.push_back({at, value});
    }
    entry.minutes.change(value);
    entry.hours.change(value);
}

void Recorder::check_clock(Instant now) {
    const auto before = timeline_->stretch(now.time);
    if (!timeline_->tick(now)) return;
    if (!full_) {
        end_stretch(before.end);
        ended_.push_back(before);
        begin_stretch(timeline_->at(now.time));
    }
}

void Recorder::set(const PropertyKey& key, double value, Instant now) {
    if (!(std::abs(value) <= kLargest)) value = kGap;
    auto found = entries_.find(key);
    if (found == entries_.end()) {
        const auto board = of_board_.find(key.board);
        if (entries_.size() >= options_.max_properties ||
            (board != of_board_.end() && board->second >= options_.max_of_board)) {
            ++refused_;
            return;
        }
        found = entries_.emplace(key, Entry{}).first;
        ++of_board_[key.board];
        auto& entry = found->second;
        entry.rows.key = key;
        if (timeline_) {
            entry.at = entry.hours_given = timeline_->at(now.time);
            entry.minutes.begin(entry.at);
            entry.hours.begin(entry.at);
        }
    }
    auto& entry = found->second;
    entry.gone = false;
    if (same_value(entry.value, value)) return;
    if (!timeline_ || full_) {
        entry.value = value;
        if (full_) ++dropped_;
        return;
    }
    check_clock(now);
    const Tick at = timeline_->at(now.time);
    if (waiting_ >= options_.max_waiting) {
        end_stretch(at);
        ended_.push_back({timeline_->stretch(now.time)});
        entry.value = value;
        full_ = true;
        ++dropped_;
        return;
    }
    put(entry, value, at);
}

void Recorder::drop(const PropertyKey& key, Instant now) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) return;
    set(key, kGap, now);
    found->second.gone = true;
}

void Recorder::give(Entry& entry, ValueRows& rows) {
    if (!full_) {
        if (const auto minute = entry.minutes.unfinished(entry.value)) entry.rows.minutes.push_back(*minute);
        if (entry.at >= entry.hours_given) {
            if (const auto hour = entry.hours.unfinished(entry.value)) {
                entry.rows.hours.push_back(*hour);
                entry.hours_given = entry.at + kHourAgain;
            }
        }
    }
    auto& own = entry.rows;
    if (own.changes.empty() && own.minutes.empty() && own.hours.empty()) return;
    rows.changes += own.changes.size();
    rows.properties.push_back(
        {own.key, std::move(own.changes), std::move(own.minutes), std::move(own.hours)});
    own.changes.clear();
    own.minutes.clear();
    own.hours.clear();
}

ValueRows Recorder::take(Instant now) {
    ValueRows rows;
    if (!timeline_) return rows;
    rows.properties.reserve(entries_.size());
    check_clock(now);
    const Tick at = timeline_->at(now.time);
    for (auto each = entries_.begin(); each != entries_.end();) {
        auto& entry = each->second;
        if (!full_) hold(entry, at);
        give(entry, rows);
        if (!entry.gone) {
            ++each;
            continue;
        }
        if (const auto board = of_board_.find(each->first.board); --board->second == 0)
            of_board_.erase(board);
        each = entries_.erase(each);
    }
    waiting_ = 0;
    rows.stretches = std::exchange(ended_, {});
    if (std::exchange(full_, false))
        begin(at, now);  // a gap lies between
    else
        rows.stretches.push_back(timeline_->stretch(now.time));
    return rows;
}

Stretch Recorder::present(Instant now) const {
    auto stretch = timeline_->stretch(now.time);
    // What is asked up to now has no gap of a moment at its end.
    stretch.end = waits() ? oldest_ : timeline_->by_clock(now);
    return stretch;
}

}  // namespace asip::registry
