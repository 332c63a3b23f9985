// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::model {

/// Of names of boards, services, models and sessions on the bus.
inline constexpr std::size_t kMaxNameBytes = 64;
/// Of the name that a board can keep in its EEPROM.
inline constexpr std::size_t kMaxStoredNameBytes = 32;

/// Whether `name` may name a service, a registry or a session: 1 to 64 of `A-Z a-z 0-9 . _ -`, and
/// neither `.` nor `..`.
bool valid_name(std::string_view name);

/// Whether `name` may name a board: a valid_name() that is none of the reserved `servicebus` and `registry`,
/// which are levels of topics. (`$...` is not a valid name anyway.)
bool valid_board_name(std::string_view name);

/// Why valid_board_name refused it, as a sentence part for a person: "'a b' holds a space; allowed are ...".
/// Unprintable bytes are shown escaped. Empty when the name is valid.
std::string explain_board_name(std::string_view name);

/// A valid board name for any text, such as a sketch or a host name: what is not allowed becomes `-`, runs of
/// it collapse, ends are trimmed, reserved names get `-board` appended; "board" when nothing is left. Of a
/// longer one the middle is left out: names of ports differ at their end.
std::string suggest_name(std::string_view text);

}  // namespace asip::model
