// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "asip/time.hpp"

namespace truth {

/// How fast this machine is just now, measured by a thread that wakes up and does a little work again and
/// again: where that takes four times as long as on a quiet machine, a second of the clock is a quarter of a
/// second for the programs that run on it. A test that waits in this time waits long enough at any load, and
/// not for ever: an answer that is still wrong then is wrong.
class Machine {
  public:
    Machine();
    ~Machine();
    Machine(const Machine&) = delete;
    Machine& operator=(const Machine&) = delete;

    /// What the programs had of the time from `from` to `to`; 0 where `to` is earlier.
    asip::Duration passed(asip::Time from, asip::Time to = asip::Clock::now()) const;
    /// Whether they lacked half a second or more of it.
    bool starved(asip::Time from, asip::Time to = asip::Clock::now()) const;

  private:
    void measure();
    asip::Duration at(asip::Time time) const;

    mutable std::mutex mutex_;
    std::condition_variable ends_;
    bool end_ = false;
    /// A time, and what the programs had had until then.
    std::vector<std::pair<asip::Time, asip::Duration>> measured_;
    std::thread thread_;
};

}  // namespace truth
