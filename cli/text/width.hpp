// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace asip::cli {

/// Nothing but printable ASCII: as many columns as bytes, and shown as it is.
bool is_plain(std::string_view text);

/// Columns a terminal needs to show UTF-8 `text`, as Unicode has them: combining marks of any script take
/// none, East Asian wide characters and emoji two, control characters none. A byte that is not UTF-8
/// (overlong forms included) counts one.
std::size_t display_width(std::string_view text);

/// `text` cut to at most `columns`, whole characters only; what was cut is shown by a final `…` (which is
/// counted).
std::string fit(std::string_view text, std::size_t columns);

/// `text` without what would move the cursor, ring the bell or turn the direction of writing: each such
/// character, and each byte that is not UTF-8, becomes `?`. Whatever was published is shown only through
/// this.
std::string for_terminal(std::string_view text);

}  // namespace asip::cli
