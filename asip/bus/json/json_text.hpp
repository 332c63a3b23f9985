// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

/// JSON written as text, for answers of thousands of items: a tree of values costs ten times as much.
namespace asip::bus {

/// Appends a string with its quotes. Bytes that are not UTF-8 become U+FFFD.
void append_json_text(std::string& out, std::string_view text);

/// The most seconds that are read or written, on both sides of 0.
inline constexpr double kMostSeconds = 1e12;

/// Appends a number of seconds, cut to milliseconds and to kMostSeconds; one that is not finite is 0.
void append_json_seconds(std::string& out, double seconds);

}  // namespace asip::bus
