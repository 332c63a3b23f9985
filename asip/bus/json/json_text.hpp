// SPDX-License-Identifier: Apache-2.0
/// JSON written as text, for answers of thousands of items: a tree of values costs ten times as much.
#pragma once
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace asip::bus {

/// Appends a string with its quotes. Bytes that are not UTF-8 become U+FFFD.
void append_json_text(std::string& out, std::string_view text);

/// The most seconds that are read or written, on both sides of 0.
inline constexpr double kMostSeconds = 1e12;

/// Appends a number of seconds, cut to milliseconds and to kMostSeconds; one that is not finite is 0.
void append_json_seconds(std::string& out, double seconds);

/// The text of a member of the object in `payload`, as it is written there; empty where there is none. Of
/// several of that name the last.
std::string_view written_member(std::string_view payload, std::string_view name);

/// Numbers that stand for something are kept as they are written: of 23 digits a float would hold 16. Each of
/// these members of `object`, which was read from `payload`, becomes a string where it is such a number.
void keep_numbers(std::string_view payload, nlohmann::json& object,
                  std::initializer_list<std::string_view> names);

}  // namespace asip::bus
