// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "asip/time.hpp"

namespace asip::catalogue {

/// When each of many slots (small integers) is due. A slot that is moved later stays in the heap until its
/// old time comes, so a renewal writes one word; one that is moved earlier is pushed anew. No slot comes out
/// before its time.
class DueSlots {
  public:
    /// Replaces what was set before.
    void set(std::uint32_t slot, Time due) {
        if (slot >= entries_.size())
            entries_.resize(std::max<std::size_t>(slot + 1, entries_.size() * 3 / 2));
        auto& entry = entries_[slot];
        if (!entry.is_set) ++size_;
        entry.due = due;
        entry.is_set = true;
        if (due < entry.listed) list(slot);
        if (heap_.size() > 2 * entries_.size() + 64) list_anew();
    }
    void remove(std::uint32_t slot) {
        if (!due(slot)) return;
        entries_[slot].is_set = false;
        --size_;
    }
    std::optional<Time> due(std::uint32_t slot) const {
        return slot < entries_.size() && entries_[slot].is_set ? std::optional(entries_[slot].due)
                                                               : std::nullopt;
    }
    std::size_t size() const { return size_; }

    /// The earliest due time; empty: nothing is set.
    std::optional<Time> next() {
        while (!heap_.empty()) {
            const auto [time, slot] = heap_.front();
            auto& entry = entries_[slot];
            if (time == entry.listed && entry.is_set && entry.due == time) return time;
            pop();
            if (time != entry.listed) continue;  // it was pushed anew since
            entry.listed = Time::max();
            if (entry.is_set) list(slot);
        }
        return std::nullopt;
    }

    /// Appends the slots that are due to `out`, earliest first, and takes them out.
    void advance(Time now, std::vector<std::uint32_t>& out) {
        for (auto due = next(); due && *due <= now; due = next()) {
            const auto slot = heap_.front().second;
            pop();
            entries_[slot].listed = Time::max();
            remove(slot);
            out.push_back(slot);
        }
    }

  private:
    struct Entry {
        Time due{};
        Time listed = Time::max();  // of the one in the heap that counts; Time::max(): none does
        bool is_set = false;
    };

    void list(std::uint32_t slot) {
        entries_[slot].listed = entries_[slot].due;
        heap_.emplace_back(entries_[slot].due, slot);
        std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
    }
    void pop() {
        std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
        heap_.pop_back();
    }
    void list_anew() {
        heap_.clear();
        for (std::uint32_t slot = 0; slot < entries_.size(); ++slot) {
            entries_[slot].listed = Time::max();
            if (entries_[slot].is_set) list(slot);
        }
    }

    std::vector<Entry> entries_;
    std::vector<std::pair<Time, std::uint32_t>> heap_;
    std::size_t size_ = 0;
};

}  // namespace asip::catalogue
