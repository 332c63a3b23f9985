// SPDX-License-Identifier: Apache-2.0
/// JSON as text, for thousands of items: a tree of values costs ten times as much.
#pragma once
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace asip::bus {

/// With its quotes. Bytes that are not UTF-8 become U+FFFD.
void append_json_text(std::string& out, std::string_view text);

/// On both sides of 0.
inline constexpr double kMostSeconds = 1e12;

/// Cut to milliseconds and to kMostSeconds; 0 where it is not finite.
void append_json_seconds(std::string& out, double seconds);

/// A member of the object in `payload` as it is written, the last of that name; may be empty.
std::string_view written_member(std::string_view payload, std::string_view name);

/// Turns these members of `object`, read from `payload`, into strings where they are numbers: of 23 digits a
/// float would hold 16.
void keep_numbers(std::string_view payload, nlohmann::json& object,
                  std::initializer_list<std::string_view> names);

}  // namespace asip::bus
