// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace asip::catalogue {

/// A sorted sequence of slots in chunks: one insertion moves at most a chunk, reading on in order is reading
/// an array. The order is the caller's and must not change while slots are in the list; functions take it as
/// `less(a, b)`.
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

    /// The first slot for which `before(slot)` is false; it must be true for none or a front part of the
    /// list.
    template <class Before>
    Position lower_bound(const Before& before) const {
        const auto chunk = std::partition_point(chunks_.begin(), chunks_.end(),
                                                [&](const Chunk& c) { return before(c.back()); });
        if (chunk == chunks_.end()) return {chunks_.size(), 0};
        const auto slot = std::partition_point(chunk->begin(), chunk->end(), before);
        return {static_cast<std::size_t>(chunk - chunks_.begin()),
                static_cast<std::size_t>(slot - chunk->begin())};
    }

    /// `slot` is not in the list.
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

    /// `slot` is in the list.
    template <class Less>
    void erase(std::uint32_t slot, const Less& less) {
        const Position p = lower_bound([&](std::uint32_t other) { return less(other, slot); });
        Chunk& chunk = chunks_[p.chunk];
        chunk.erase(chunk.begin() + static_cast<std::ptrdiff_t>(p.offset));
        if (chunk.empty()) chunks_.erase(chunks_.begin() + static_cast<std::ptrdiff_t>(p.chunk));
        --size_;
    }

    /// All in one pass: `added` (not in the list) and `removed` (in it), both sorted.
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

}  // namespace asip::catalogue
