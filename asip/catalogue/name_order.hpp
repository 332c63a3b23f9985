// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "asip/catalogue/slot_list.hpp"

namespace asip::catalogue {

/// All boards in the order of their names, and for each a label (a number that orders like its name), so that
/// every other index compares numbers. New boards are put in place when a caller asks: a hundred thousand at
/// once are sorted once, not one by one.
class NameOrder {
  public:
    void add(std::uint32_t slot) { pending_.push_back(slot); }

    /// `name_less(a, b)` by the names of two slots. Labels of slots settled before keep their order, not
    /// their values.
    template <class NameLess>
    void settle(const NameLess& name_less) {
        if (pending_.empty()) return;
        for (const std::uint32_t slot : pending_) {
            if (slot >= labels_.size()) labels_.resize(slot + 1);
        }
        if (pending_.size() > 16 + list_.size() / 8) {
            std::sort(pending_.begin(), pending_.end(), name_less);
            list_.merge(pending_, {}, name_less);
            relabel();
        } else {
            for (const std::uint32_t slot : pending_)
                insert(slot, name_less);
        }
        pending_.clear();
        if (pending_.capacity() > 4096) pending_.shrink_to_fit();
    }

    /// Of a settled slot.
    void erase(std::uint32_t slot) {
        list_.erase(slot, [this](std::uint32_t a, std::uint32_t b) { return labels_[a] < labels_[b]; });
    }

    std::uint64_t label(std::uint32_t slot) const { return labels_[slot]; }
    const SlotList& list() const { return list_; }
    bool settled() const { return pending_.empty(); }

  private:
    template <class NameLess>
    void insert(std::uint32_t slot, const NameLess& name_less) {
        SlotList::Position p = list_.insert(slot, name_less);
        std::uint64_t below = 0;
        if (p.offset > 0) {
            below = labels_[list_.at({p.chunk, p.offset - 1})];
        } else if (p.chunk > 0) {
            below = labels_[list_.last(p.chunk - 1)];
        }
        list_.step(p);
        const std::uint64_t above = list_.at_end(p) ? UINT64_MAX : labels_[list_.at(p)];
        if (above - below < 2) {
            relabel();
        } else {
            // At either end a fixed stride: names that count up would otherwise halve what is left each time.
            constexpr std::uint64_t kStride = std::uint64_t{1} << 32;
            const std::uint64_t half = (above - below) / 2;
            labels_[slot] = list_.at_end(p) && half > kStride ? below + kStride : below + half;
        }
    }

    void relabel() {
        const std::uint64_t stride = UINT64_MAX / 2 / (list_.size() + 1);
        std::uint64_t label = 0;
        list_.for_each([&](std::uint32_t slot) { labels_[slot] = label += stride; });
    }

    SlotList list_;
    std::vector<std::uint32_t> pending_;
    std::vector<std::uint64_t> labels_;
};

/// Some of the boards in the order of their names: those in one state that have one kind of service. Changes
/// wait until settled, too.
class BoardSet {
  public:
    void add(std::uint32_t slot) { pending_.emplace_back(slot, true), ++size_; }
    void remove(std::uint32_t slot) { pending_.emplace_back(slot, false), --size_; }
    std::size_t size() const { return size_; }
    bool settled() const { return pending_.empty(); }

    void settle(const NameOrder& order);
    const SlotList& list() const { return list_; }

  private:
    SlotList list_;
    std::vector<std::pair<std::uint32_t, bool>> pending_;
    std::size_t size_ = 0;
};

}  // namespace asip::catalogue
