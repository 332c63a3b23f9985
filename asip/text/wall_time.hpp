// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace asip::text {

/// Time of day in UTC, to be shown. Nothing is measured with it, as it jumps when the clock is set. The
/// default, 1970, often stands for "unknown".
using WallTime = std::chrono::sys_time<std::chrono::milliseconds>;

WallTime wall_now();

/// `2026-11-21T00:48:09.123Z`, 24 characters for the years 0 to 9999.
std::string iso_time(WallTime time);
inline std::string iso_time(std::chrono::system_clock::time_point time) {
    return iso_time(std::chrono::floor<std::chrono::milliseconds>(time));
}

/// What iso_time() writes, or its beginning until the day, the minute, the second; with or without the Z.
/// Nothing: another text, or no day of the calendar.
std::optional<WallTime> parse_iso_time(std::string_view written);

}  // namespace asip::text
