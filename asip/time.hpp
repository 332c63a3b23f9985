#pragma once
#include <chrono>

namespace asip {

/// The monotonic clock that leases, timeouts and ages are measured by. The cores take a Time as an argument
/// and never read a clock themselves.
using Clock = std::chrono::steady_clock;
using Time = Clock::time_point;
using Duration = Clock::duration;

}  // namespace asip
