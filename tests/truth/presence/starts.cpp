// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/presence/starts.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace truth::presence {
namespace {

constexpr const char* kClockTexts[] = {"first session", "later session", "clock behind"};
constexpr const char* kBeforeTexts[] = {"one that ended", "a living one", "one cut off, its lease runs",
                                        "one cut off, its lease over", "one cut off, its will came"};

}  // namespace

std::optional<Clock> clock_of_second(std::uint64_t seed) {
    if (seed % 3 == 2) return Clock::kBehind;
    const auto rest = seed % 27;
    if (rest == 9 || rest == 18 || rest == 19) return std::nullopt;
    return seed % 9 == 7 || seed % 18 == 6 ? Clock::kFirst : Clock::kLater;
}

std::size_t Starts::place(const StartKind& kind) {
    return (static_cast<std::size_t>(kind.clock) * kBefore + static_cast<std::size_t>(kind.before)) * kKinds +
           (kind.bridged ? 2 : 0) + (kind.takeover ? 1 : 0);
}

Starts& Starts::operator+=(const Starts& other) {
    for (std::size_t i = 0; i < counts_.size(); ++i)
        counts_[i] += other.counts_[i];
    return *this;
}

std::vector<std::string> Starts::lines() const {
    std::vector<std::string> lines{fmt::format("{:<15}{:<29}{:>10}{:>10}{:>10}{:>10}", "starts of agents",
                                               " behind", "one broker", "takeover", "bridged", "takeover")};
    for (std::size_t clock = 0; clock < kClocks; ++clock) {
        for (std::size_t before = 0; before < kBefore; ++before) {
            const auto* counts = &counts_[(clock * kBefore + before) * kKinds];
            if (!can_be(clock, before)) continue;
            lines.push_back(fmt::format("{:<15} {:<29}{:>10}{:>10}{:>10}{:>10}", kClockTexts[clock],
                                        kBeforeTexts[before], counts[0], counts[1], counts[2], counts[3]));
        }
    }
    return lines;
}

bool Starts::can_be(std::size_t clock, std::size_t before) {
    return clock != static_cast<std::size_t>(Clock::kFirst) ||
           before != static_cast<std::size_t>(Before::kLeaseRuns);
}

std::uint64_t Starts::rarest() const {
    auto rarest = UINT64_MAX;
    for (std::size_t place = 0; place < counts_.size(); ++place)
        if (can_be(place / kKinds / kBefore, place / kKinds % kBefore))
            rarest = std::min(rarest, counts_[place]);
    return rarest;
}

}  // namespace truth::presence
