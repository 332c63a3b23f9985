// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

namespace asip::catalogue {

/// From a hash to the slots of boards whose names have it: eight bytes an entry, linear probing. Names live
/// elsewhere.
class NameTable {
  public:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;

    /// The slot with this hash for which `same(slot)`, or kNone.
    template <class Same>
    std::uint32_t find(std::uint64_t hash, const Same& same) const {
        if (entries_.empty()) return kNone;
        const auto tag = static_cast<std::uint32_t>(hash >> 32);
        for (std::size_t i = hash & mask(); entries_[i].slot != kNone; i = (i + 1) & mask()) {
            if (entries_[i].tag == tag && same(entries_[i].slot)) return entries_[i].slot;
        }
        return kNone;
    }

    /// `hash_of(slot)` for slots already here, needed when the table grows.
    template <class HashOf>
    void insert(std::uint64_t hash, std::uint32_t slot, const HashOf& hash_of) {
        if ((size_ + 1) * 4 > entries_.size() * 3) grow(hash_of);
        put(hash, slot);
        ++size_;
    }

    template <class HashOf>
    void erase(std::uint64_t hash, std::uint32_t slot, const HashOf& hash_of) {
        std::size_t hole = hash & mask();
        while (entries_[hole].slot != slot)
            hole = (hole + 1) & mask();
        // Entries behind the hole move up into it unless they would leave the run that begins at their own
        // place.
        for (std::size_t i = (hole + 1) & mask(); entries_[i].slot != kNone; i = (i + 1) & mask()) {
            const std::size_t home = hash_of(entries_[i].slot) & mask();
            if (((i - home) & mask()) >= ((i - hole) & mask())) {
                entries_[hole] = entries_[i];
                hole = i;
            }
        }
        entries_[hole] = Entry{};
        --size_;
    }

    std::size_t size() const { return size_; }

  private:
    struct Entry {
        std::uint32_t tag = 0;
        std::uint32_t slot = kNone;
    };

    std::size_t mask() const { return entries_.size() - 1; }

    void put(std::uint64_t hash, std::uint32_t slot) {
        std::size_t i = hash & mask();
        while (entries_[i].slot != kNone)
            i = (i + 1) & mask();
        entries_[i] = {static_cast<std::uint32_t>(hash >> 32), slot};
    }

    template <class HashOf>
    void grow(const HashOf& hash_of) {
        std::vector<Entry> old(entries_.empty() ? 64 : entries_.size() * 2);
        old.swap(entries_);
        for (const Entry& entry : old) {
            if (entry.slot != kNone) put(hash_of(entry.slot), entry.slot);
        }
    }

    std::vector<Entry> entries_;
    std::size_t size_ = 0;
};

}  // namespace asip::catalogue
