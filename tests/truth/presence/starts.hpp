// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace truth::presence {

/// An agent's clock when it starts, by the sessions that its board had.
enum class Clock { kFirst, kLater, kBehind };
/// The agent that had the board before it.
enum class Before {
    kEnded,  ///< stopped, killed, or there was none
    kLives,
    kLeaseRuns,  ///< cut off; its lease runs, its will is to come
    kLeaseOver,  ///< the same, behind its lease
    kWillCame,   ///< cut off; its will was published; it may come back
};

struct StartKind {
    Clock clock = Clock::kFirst;
    Before before = Before::kEnded;
    bool bridged = false;
    bool takeover = false;
};

/// How often agents started in which way.
class Starts {
  public:
    void add(const StartKind& kind) { ++counts_[place(kind)]; }
    Starts& operator+=(const Starts& other);

    std::vector<std::string> lines() const;
    /// Of the kinds with a clock that is behind, the rarest one.
    std::uint64_t rarest_behind() const;

  private:
    static constexpr std::size_t kClocks = 3, kBefore = 5;
    static std::size_t place(const StartKind& kind);

    std::array<std::uint64_t, kClocks * kBefore * 4> counts_{};
};

}  // namespace truth::presence
