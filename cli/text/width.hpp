#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace asip::cli {

/// Nothing but printable ASCII: as many columns as bytes, and shown as it is.
bool is_plain(std::string_view text);

/// Columns a terminal needs to show UTF-8 `text`: combining marks take none, East Asian wide characters and
/// emoji two, control characters none. A byte that is not UTF-8 counts one.
std::size_t display_width(std::string_view text);

/// `text` cut to at most `columns`, whole characters only; what was cut is shown by a final `…` (which is
/// counted).
std::string fit(std::string_view text, std::size_t columns);

/// `text` without what would move the cursor or ring the bell: each control character becomes `?`. What
/// strangers publish is shown only through this.
std::string printable(std::string_view text);

}  // namespace asip::cli
