// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "tests/truth/board/firmware.hpp"
#include "tests/truth/ledger.hpp"

namespace truth {

/// Exceptions that a history had, by kind.
struct Excused {
    std::array<std::uint8_t, 4> counts{};
    bool operator==(const Excused&) const = default;
};
Excused excused_of(const Counts& counts);
void add(Counts& counts, const Excused& excused);

/// States, by their fingerprints, from which a history without more faults came to a good end.
class KnownStates {
  public:
    struct Rest {
        std::uint32_t time = 0;  ///< until the end, in microseconds
        Excused excused;         ///< until then
    };
    /// States of one history, with what was excused up to each.
    struct Passed {
        std::uint64_t state;
        Micros at;
        Excused excused;
        bool recent;  ///< true only where the end comes soon (kSoon)
    };
    using Path = std::vector<Passed>;

    /// Takes up to so many bytes; later states are not added.
    explicit KnownStates(std::size_t max_bytes);

    std::optional<Rest> find(std::uint64_t state) const;
    /// False: it is there already, or there is no room.
    bool add(std::uint64_t state, Rest rest);
    /// The history that passed these states came to a good end.
    void add(const Path& path, Micros end, const Excused& excused);
    std::size_t size() const { return size_; }

  private:
    struct Slot {
        std::uint64_t state = 0;  // 0: empty
        Rest rest;
    };
    std::size_t place(std::uint64_t state) const;
    void grow();

    std::vector<Slot> slots_;
    std::size_t size_ = 0;
    std::size_t max_slots_;
};

}  // namespace truth
