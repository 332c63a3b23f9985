// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "asip/time.hpp"

namespace truth {

/// How much of a time the programs of a machine had, by the wake-ups of a thread among them: where it takes
/// four times as long as on a quiet machine to wake up and do a little work, a second of the clock is a
/// quarter of a second for the programs. Pure.
class Pace {
  public:
    static constexpr asip::Duration kSleep = std::chrono::milliseconds(100);
    // More than a scheduler gives a thread at once because it slept: what comes behind that takes as long as
    // it takes a program that starts, or simulates a board.
    static constexpr asip::Duration kWork = std::chrono::milliseconds(10);
    // A timer of a quiet machine is late by less.
    static constexpr asip::Duration kLateness = std::chrono::milliseconds(1);
    static constexpr asip::Duration kStarved = std::chrono::milliseconds(500);

    explicit Pace(asip::Time begin) : measured_{{begin, asip::Duration{}}} {}

    /// The thread slept until `due`, and its kWork was done at `done`.
    void woke(asip::Time due, asip::Time done);
    /// What the programs had of the time from `from` to `to`; 0 where `to` is earlier.
    asip::Duration passed(asip::Time from, asip::Time to) const;
    /// Whether they lacked half a second or more of it: a wrong answer says nothing of them.
    bool starved(asip::Time from, asip::Time to) const { return (to - from) - passed(from, to) >= kStarved; }
    /// Whether they had time enough to say what happened at `since`, and is promised within `limit`: what is
    /// wrong then is wrong, at any load.
    bool had_time(asip::Time since, asip::Duration limit, asip::Time now) const {
        return passed(since, now) >= 4 * limit + std::chrono::seconds(3);
    }

  private:
    asip::Duration at(asip::Time time) const;

    /// A time, and what the programs had had until then.
    std::vector<std::pair<asip::Time, asip::Duration>> measured_;
};

/// The pace of this machine just now.
class Machine {
  public:
    Machine() : thread_([this] { measure(); }) {}
    ~Machine();
    Machine(const Machine&) = delete;
    Machine& operator=(const Machine&) = delete;

    /// As it is now.
    Pace pace() const {
        const std::lock_guard lock(mutex_);
        return pace_;
    }

  private:
    void measure();

    mutable std::mutex mutex_;
    std::condition_variable ends_;
    bool end_ = false;
    Pace pace_{asip::Clock::now()};
    std::thread thread_;
};

}  // namespace truth
