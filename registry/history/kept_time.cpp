// SPDX-License-Identifier: Apache-2.0
#include "registry/history/kept_time.hpp"

#include <algorithm>
#include <fstream>

namespace asip::registry {
namespace {

using Milliseconds = KeptTime::Milliseconds;

constexpr Milliseconds kFirst{1};  // 0 is what an earlier version of the file has
constexpr Milliseconds kMax = std::chrono::years(1000);

Milliseconds monotonic(Time time) {
    return std::chrono::floor<Milliseconds>(time.time_since_epoch());
}

Milliseconds difference(Instant now) {
    return now.wall.time_since_epoch() - monotonic(now.time);
}

}  // namespace

KeptTime::KeptTime(std::string boot, Instant now)
    : boot_(std::move(boot)), start_(now.time), difference_(difference(now)), unset_since_(now.time) {}

void KeptTime::load(const std::optional<Mark>& mark, Instant now) {
    if (!mark) return;
    base_ = std::clamp(mark->kept, kFirst, kMax);
    const Milliseconds here = monotonic(now.time);
    const bool same_run = !boot_.empty() && mark->boot == boot_ && mark->monotonic <= here;
    if (same_run) {
        // From the mark to now, of which what passed since start_ is counted by at().
        base_ += here - mark->monotonic - std::chrono::floor<Milliseconds>(now.time - start_);
        const auto then = mark->wall.time_since_epoch() - mark->monotonic;
        if (mark->proven && std::chrono::abs(difference_ - then) <= kSet) unset_since_ = start_ - kProven;
    } else if (mark->proven) {
        before_the_gap_ = mark;
    }
}

void KeptTime::tick(Instant now) {
    const Milliseconds present = difference(now);
    if (std::chrono::abs(present - difference_) > kSet) {
        difference_ = present;
        unset_since_ = now.time;
    }
    if (!before_the_gap_ || !proven(now.time)) return;
    const auto running = std::chrono::floor<Milliseconds>(now.time - start_);
    base_ += std::max(Milliseconds(0), now.wall - before_the_gap_->wall - running);
    before_the_gap_.reset();
}

Milliseconds KeptTime::at(Time time) const {
    return base_ + std::chrono::floor<Milliseconds>(time - start_);
}

KeptTime::Mark KeptTime::mark(Instant now) const {
    return {at(now.time), now.wall, proven(now.time), boot_, monotonic(now.time)};
}

std::string boot_id() {
    std::ifstream file("/proc/sys/kernel/random/boot_id");
    std::string id;
    file >> id;
    return id.substr(0, 64);
}

}  // namespace asip::registry
