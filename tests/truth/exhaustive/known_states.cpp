// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/exhaustive/known_states.hpp"

#include <algorithm>
#include <utility>

#include "tests/truth/exhaustive/trial.hpp"

namespace truth {

namespace {

constexpr std::size_t kFirstSlots = 1 << 12;

// More than a byte holds are not told apart: such a history is never taken for another.
constexpr std::uint8_t kMany = 255;

std::uint8_t in_byte(std::uint64_t count) {
    return static_cast<std::uint8_t>(std::min<std::uint64_t>(count, kMany));
}

}  // namespace

Excused excused_of(const Counts& counts) {
    return {{in_byte(counts.not_executed), in_byte(counts.wrong_values), in_byte(counts.wrong_summed),
             in_byte(counts.not_restored)}};
}

void add(Counts& counts, const Excused& excused) {
    counts.not_executed += excused.counts[0];
    counts.wrong_values += excused.counts[1];
    counts.wrong_summed += excused.counts[2];
    counts.not_restored += excused.counts[3];
}

KnownStates::KnownStates(std::size_t max_bytes) : slots_(kFirstSlots), max_slots_(max_bytes / sizeof(Slot)) {}

std::size_t KnownStates::place(std::uint64_t state) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = state & mask;
    while (slots_[at].state != 0 && slots_[at].state != state)
        at = (at + 1) & mask;
    return at;
}

std::optional<KnownStates::Rest> KnownStates::find(std::uint64_t state) const {
    const Slot& slot = slots_[place(state)];
    if (slot.state == 0) return std::nullopt;
    return slot.rest;
}

bool KnownStates::add(std::uint64_t state, Rest rest) {
    if (state == 0) return false;
    if (size_ * 2 >= slots_.size()) {
        if (slots_.size() * 2 > max_slots_) return false;
        grow();
    }
    Slot& slot = slots_[place(state)];
    if (slot.state != 0) return false;
    slot = {state, rest};
    ++size_;
    return true;
}

void KnownStates::grow() {
    auto before = std::exchange(slots_, std::vector<Slot>(slots_.size() * 2));
    for (const Slot& slot : before)
        if (slot.state != 0) slots_[place(slot.state)] = slot;
}

void KnownStates::add(const Path& path, Micros end, const Excused& excused) {
    for (const Passed& passed : path) {
        const Micros time = end - passed.at;
        if (passed.recent && time > kSoon) continue;
        Rest rest{static_cast<std::uint32_t>(time), {}};
        bool many = false;
        for (std::size_t i = 0; i < rest.excused.counts.size(); ++i) {
            many = many || excused.counts[i] == kMany;
            rest.excused.counts[i] = static_cast<std::uint8_t>(excused.counts[i] - passed.excused.counts[i]);
        }
        if (!many) add(passed.state, rest);
    }
}

}  // namespace truth
