// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

/// JSON written as text, for answers of thousands of items: a tree of values costs ten times as much.
namespace asip::bus {

/// Appends a string with its quotes. Bytes that are not UTF-8 become U+FFFD.
void append_json_text(std::string& out, std::string_view text);

/// Appends a number of seconds, cut to milliseconds and to 1e12 on both sides; one that is not finite is 0.
void append_json_seconds(std::string& out, double seconds);

}  // namespace asip::bus
