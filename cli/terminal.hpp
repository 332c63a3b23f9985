// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace asip::cli {

/// Columns of the terminal that this file descriptor is, at least 20; 0 when it is none.
std::size_t terminal_width(int descriptor);

enum class ColourChoice { kAuto, kAlways, kNever };

/// Whether a terminal whose TERM this is can be cleared and coloured: not where that is unset, empty or
/// `dumb`.
bool knows_escapes(const std::optional<std::string>& term);

/// Whether to use colours: as chosen; on kAuto only a terminal that knows_escapes(), and not when NO_COLOR
/// holds anything.
bool use_colour(ColourChoice choice, bool terminal,
                const std::function<std::optional<std::string>(const std::string&)>& variables);

}  // namespace asip::cli
