// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::text {

/// Text from anywhere, made fit for one line of a message or log: control characters, the backslash and bytes
/// beyond ASCII become `\xNN`. Of a text longer than `max_bytes` the first `max_bytes` are shown, with `...`
/// behind them; escaping makes the result up to four times as long.
std::string printable(std::string_view text, std::size_t max_bytes = 80);

/// The whole text in one line, for a person. UTF-8 is kept: only control characters (below U+0020, U+007F to
/// U+009F) and those of begins_unseen() become `\xNN`. The result is always showable.
std::string escape_controls(std::string_view text);

/// JSON that says the same and can be written to a terminal as it is: characters that it would obey (U+007F
/// to U+009F) or that no one sees become `\\uNNNN`. Line ends and blanks between its parts stay.
std::string escape_json(std::string document);

/// An address to be shown in a message or log: what stands before its last `@`, a user and perhaps a
/// password, is left out, `mqtt://...@host:1883`.
std::string without_credentials(std::string_view address);

/// Whether text from another program can be written to a terminal as it is: it holds no control
/// characters, so that it cannot move the cursor or change colours. Whether it is UTF-8 is not checked.
bool is_showable(std::string_view text);

/// Whether a character of UTF-8 at the beginning of `text` is one that no one sees; some of them turn the
/// order of what follows. U+061C, U+200B to U+200F, U+2028 to U+202E, U+2060 to U+2069, U+FEFF.
bool begins_unseen(std::string_view text);

}  // namespace asip::text
