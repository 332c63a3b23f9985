#pragma once
#include <string>
#include <string_view>

namespace asip::text {

/// Text for a message of one line: control characters, the backslash and bytes beyond ASCII become `\xNN`;
/// what is longer than `max_bytes` is cut, with `...` behind it.
std::string printable(std::string_view text, std::size_t max_bytes = 80);

/// The whole text in one line, UTF-8 kept: only control characters (below U+0020, U+007F to U+009F) become
/// `\xNN`. The result is always showable.
std::string escape_controls(std::string_view text);

/// Whether text from another program can be written to a terminal as it is: it holds no control characters.
bool is_showable(std::string_view text);

}  // namespace asip::text
