// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>

namespace asip {

/// The monotonic clock by which leases, timeouts and ages are measured. It has no relation to the time of day
/// (that is text::WallTime) and none to the clock of another process.
///
/// Classes that are called pure take a Time as an argument and never read the clock. They expect times that
/// do not go back from one call to the next.
using Clock = std::chrono::steady_clock;
using Time = Clock::time_point;
using Duration = Clock::duration;

}  // namespace asip
