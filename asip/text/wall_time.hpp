#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace asip::text {

/// Time of day in UTC, in milliseconds: for people and for the bus. Nothing is measured with it.
using WallTime = std::chrono::sys_time<std::chrono::milliseconds>;

WallTime wall_now();

/// `2026-11-21T00:48:09.123Z`
std::string iso_time(WallTime time);
inline std::string iso_time(std::chrono::system_clock::time_point time) {
    return iso_time(std::chrono::floor<std::chrono::milliseconds>(time));
}

/// Reads exactly what iso_time() writes; nothing for any other text or a day that is not in the calendar.
std::optional<WallTime> parse_iso_time(std::string_view text);

}  // namespace asip::text
