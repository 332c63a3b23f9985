// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace truth::presence {

/// An agent's clock when it starts, by the sessions that its board had.
enum class Clock { kFirst, kLater, kBehind };
/// Eight of nine histories begin with a board that changes hands; what is left is as it comes. Seeds of
/// earlier failures play the same histories.
std::optional<Clock> clock_of_second(std::uint64_t seed);
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
    /// How often the rarest kind that there can be came.
    std::uint64_t rarest() const;

  private:
    static constexpr std::size_t kClocks = 3, kBefore = 5;
    static constexpr std::size_t kKinds = 4;  // of brokers, with and without a takeover
    static std::size_t place(const StartKind& kind);
    /// A lease runs behind a description: then there is a session.
    static bool can_be(std::size_t clock, std::size_t before);

    std::array<std::uint64_t, kClocks * kBefore * kKinds> counts_{};
};

}  // namespace truth::presence
