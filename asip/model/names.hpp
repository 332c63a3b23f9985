// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::model {

/// For names of boards, services, models and sessions.
inline constexpr std::size_t kMaxNameBytes = 64;
/// For the name in a board's EEPROM.
inline constexpr std::size_t kMaxStoredNameBytes = 32;

/// For a service, a registry or a session: 1 to 64 of `A-Z a-z 0-9 . _ -`, and neither `.` nor `..`.
bool valid_name(std::string_view name);

/// A valid_name() that is not `servicebus` or `registry`, which are levels of topics.
bool valid_board_name(std::string_view name);

/// Why not, for a person: "'a b' holds a space; allowed are ...", unprintable bytes escaped. Empty: it is
/// valid.
std::string explain_board_name(std::string_view name);

/// A valid board name from any text: what is not allowed becomes `-`, runs collapse, ends are trimmed,
/// reserved names get `-board`; "board" for nothing. The middle of a longer one goes, because names of ports
/// differ at their end.
std::string suggest_name(std::string_view text);

}  // namespace asip::model
