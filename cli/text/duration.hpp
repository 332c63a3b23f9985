#pragma once
#include <chrono>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::cli {

/// `0.42 ms`, `12 ms`, `3.1 s`, `4 min`, `2 h`, `9 d`: as coarse as a person needs.
std::string duration_text(std::chrono::duration<double> duration);

/// `2026-11-21T00:48:09.123Z`
std::string iso_time(std::chrono::system_clock::time_point when);

/// `500ms`, `10s`, `5m`, `2h`, or a number of seconds.
Expected<std::chrono::milliseconds> parse_duration(std::string_view text);

}  // namespace asip::cli
