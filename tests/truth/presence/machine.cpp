// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/presence/machine.hpp"

#include <algorithm>
#include <ctime>

namespace truth {

using asip::Clock;
using asip::Duration;
using asip::Time;

namespace {

Duration processor_time() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

void Pace::woke(Time due, Time done) {
    const double slower = std::max(
        1.0, std::chrono::duration<double>(done - due) / std::chrono::duration<double>(kWork + kLateness));
    const auto [before, had] = measured_.back();
    measured_.emplace_back(done, had + std::chrono::duration_cast<Duration>((done - before) / slower));
}

Duration Pace::passed(Time from, Time to) const {
    return std::max(at(to) - at(from), Duration{});
}

Duration Pace::at(Time time) const {
    const auto after = std::upper_bound(measured_.begin(), measured_.end(), time,
                                        [](Time wanted, const auto& one) { return wanted < one.first; });
    if (after == measured_.begin()) return {};
    const auto& [before, had] = *std::prev(after);
    // Behind the last measurement the machine is taken to be quiet, for one measurement at most.
    if (after == measured_.end()) return had + std::min<Duration>(time - before, kSleep + kWork);
    const double part =
        std::chrono::duration<double>(time - before) / std::chrono::duration<double>(after->first - before);
    return had + std::chrono::duration_cast<Duration>((after->second - had) * part);
}

Machine::~Machine() {
    {
        const std::lock_guard lock(mutex_);
        end_ = true;
    }
    ends_.notify_one();
    thread_.join();
}

void Machine::measure() {
    for (;;) {
        const Time due = Clock::now() + Pace::kSleep;
        {
            std::unique_lock lock(mutex_);
            if (ends_.wait_until(lock, due, [this] { return end_; })) return;
        }
        const Duration begin = processor_time();
        while (processor_time() < begin + Pace::kWork) {
        }
        const std::lock_guard lock(mutex_);
        pace_.woke(due, Clock::now());
    }
}

}  // namespace truth
