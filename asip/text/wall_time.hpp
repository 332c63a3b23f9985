// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace asip::text {

/// Time of day in UTC, in milliseconds, to be shown to people and sent over the bus. Nothing is measured with
/// it, as it jumps when the clock is set. A default-constructed one is 1970 and often stands for "unknown".
using WallTime = std::chrono::sys_time<std::chrono::milliseconds>;

/// The time of day of this machine now.
WallTime wall_now();

/// ISO 8601 in UTC with milliseconds, always 24 characters for the years 0 to 9999:
/// `2026-11-21T00:48:09.123Z`.
std::string iso_time(WallTime time);
inline std::string iso_time(std::chrono::system_clock::time_point time) {
    return iso_time(std::chrono::floor<std::chrono::milliseconds>(time));
}

/// Reads exactly what iso_time() writes. Nothing for any other text (no other zone, no missing milliseconds)
/// or for a day that is not in the calendar.
std::optional<WallTime> parse_iso_time(std::string_view text);

}  // namespace asip::text
