// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "asip/model/board_state.hpp"

namespace asip::catalogue {

/// A sorted sequence of slots in chunks: an insertion moves at most a chunk. The order, `less(a, b)`, must
/// not change while slots are in the list.
class SlotList {
  public:
    struct Position {
        std::size_t chunk = 0;
        std::size_t offset = 0;
    };

    std::size_t size() const { return size_; }
    bool at_end(Position p) const { return p.chunk == chunks_.size(); }
    std::uint32_t at(Position p) const { return chunks_[p.chunk][p.offset]; }
    std::uint32_t last(std::size_t chunk) const { return chunks_[chunk].back(); }
    void step(Position& p) const {
        if (++p.offset == chunks_[p.chunk].size()) p = {p.chunk + 1, 0};
    }

    /// The first slot for which `before(slot)` is false; `before` must hold for a front part of the list.
    template <class Before>
    Position lower_bound(const Before& before) const {
        const auto chunk = std::partition_point(chunks_.begin(), chunks_.end(),
                                                [&](const Chunk& c) { return before(c.back()); });
        if (chunk == chunks_.end()) return {chunks_.size(), 0};
        const auto slot = std::partition_point(chunk->begin(), chunk->end(), before);
        return {static_cast<std::size_t>(chunk - chunks_.begin()),
                static_cast<std::size_t>(slot - chunk->begin())};
    }

    template <class Less>
    Position insert(std::uint32_t slot, const Less& less) {
        Position p = lower_bound([&](std::uint32_t other) { return less(other, slot); });
        ++size_;
        if (chunks_.empty()) {
            chunks_.push_back({slot});
            return {0, 0};
        }
        if (at_end(p)) p = {chunks_.size() - 1, chunks_.back().size()};
        Chunk& chunk = chunks_[p.chunk];
        chunk.insert(chunk.begin() + static_cast<std::ptrdiff_t>(p.offset), slot);
        if (chunk.size() > kMost) {
            const std::size_t half = chunk.size() / 2;
            Chunk rest(chunk.begin() + static_cast<std::ptrdiff_t>(half), chunk.end());
            chunk.resize(half);
            chunks_.insert(chunks_.begin() + static_cast<std::ptrdiff_t>(p.chunk + 1), std::move(rest));
            if (p.offset >= half) p = {p.chunk + 1, p.offset - half};
        }
        return p;
    }

    template <class Less>
    void erase(std::uint32_t slot, const Less& less) {
        const Position p = lower_bound([&](std::uint32_t other) { return less(other, slot); });
        Chunk& chunk = chunks_[p.chunk];
        chunk.erase(chunk.begin() + static_cast<std::ptrdiff_t>(p.offset));
        if (chunk.empty()) chunks_.erase(chunks_.begin() + static_cast<std::ptrdiff_t>(p.chunk));
        --size_;
    }

    /// In one pass: `added` (not in the list) and `removed` (in it), both sorted.
    template <class Less>
    void merge(const std::vector<std::uint32_t>& added, const std::vector<std::uint32_t>& removed,
               const Less& less) {
        std::vector<Chunk> old = std::move(chunks_);
        chunks_.clear();
        const std::size_t total = size_ + added.size() - removed.size();
        size_ = total;
        auto add = added.begin();
        auto remove = removed.begin();
        for (const Chunk& chunk : old) {
            for (const std::uint32_t slot : chunk) {
                for (; add != added.end() && less(*add, slot); ++add)
                    append(*add);
                if (remove != removed.end() && *remove == slot) {
                    ++remove;
                } else {
                    append(slot);
                }
            }
        }
        for (; add != added.end(); ++add)
            append(*add);
        if (!chunks_.empty()) chunks_.back().shrink_to_fit();
    }

    template <class Visit>
    void for_each(const Visit& visit) const {
        for (const Chunk& chunk : chunks_) {
            for (const std::uint32_t slot : chunk)
                visit(slot);
        }
    }

  private:
    using Chunk = std::vector<std::uint32_t>;
    static constexpr std::size_t kMost = 512;
    static constexpr std::size_t kFill = 384;  // after a merge: room for some to come without a split

    void append(std::uint32_t slot) {
        if (chunks_.empty() || chunks_.back().size() == kFill) {
            chunks_.emplace_back();
            chunks_.back().reserve(kFill);
        }
        chunks_.back().push_back(slot);
    }

    std::vector<Chunk> chunks_;
    std::size_t size_ = 0;
};

/// All boards in the order of their names, each with a label, a number that orders like the name, so that
/// other indices compare numbers. New boards are put in place when a caller asks: many at once are sorted
/// once.
class NameOrder {
  public:
    void add(std::uint32_t slot) { pending_.push_back(slot); }

    /// `name_less(a, b)` by the names of two slots. Settled slots keep the order of their labels, not their
    /// values.
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

    /// `slot` is settled.
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

/// The boards in one state that have one kind of service, in the order of names. Changes wait until settled.
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

inline constexpr std::size_t kStates = 5;
constexpr std::size_t index_of(model::BoardState state) {
    return static_cast<std::size_t>(state);
}

/// The boards with a kind of service, by state.
struct Kind {
    std::string name;
    std::vector<std::string> units;  // of the standard model
    std::array<BoardSet, kStates> boards;
    std::array<std::size_t, kStates> services{};  // a board may have several of one kind
    std::uint32_t references = 0;                 // service lists that mention it
    bool dirty = false;                           // some of `boards` has changes that wait
};

using UnitsOf = std::function<std::vector<std::string>(std::string_view model)>;

/// A dirty kind that no service list mentions is dropped when it is settled.
class KindTable {
  public:
    explicit KindTable(UnitsOf units_of) : units_of_(std::move(units_of)) {}

    /// Adds a reference, and the kind if it is new. `model` ("distance@1") gives its units; may be empty.
    Kind* refer(std::string_view name, std::string_view model);
    void release(Kind* kind);
    void mark_dirty(Kind* kind);
    void settle(const NameOrder& order);
    bool settled() const { return dirty_.empty(); }
    Kind* find(std::string_view name) const;
    const std::unordered_map<std::string, std::unique_ptr<Kind>>& all() const { return kinds_; }

  private:
    UnitsOf units_of_;
    std::unordered_map<std::string, std::unique_ptr<Kind>> kinds_;
    std::vector<Kind*> dirty_;
};

}  // namespace asip::catalogue
