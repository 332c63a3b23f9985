// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::text {

/// For one line of a message or log: control characters, the backslash and bytes beyond ASCII become `\xNN`.
/// Longer texts are cut to `max_bytes`, with `...`; escaping makes that up to four times as long.
std::string printable(std::string_view text, std::size_t max_bytes = 80);

/// One showable line for a person: control characters (below U+0020, U+007F to U+009F) and those of
/// begins_unseen() become `\xNN`.
std::string escape_controls(std::string_view text);

/// The same JSON for a terminal: characters that it would obey (U+007F to U+009F) or that no one sees become
/// `\\uNNNN`.
std::string escape_json(std::string document);

/// An address without user and password: `mqtt://...@host:1883`.
std::string without_credentials(std::string_view address);

/// It has no control characters, which could move the cursor or change colours. UTF-8 is not checked.
bool is_showable(std::string_view text);

/// It begins with a character that no one sees: U+061C, U+200B to U+200F, U+2028 to U+202E, U+2060 to U+2069,
/// U+FEFF.
bool begins_unseen(std::string_view text);

}  // namespace asip::text
