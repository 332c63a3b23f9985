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

/// Whether to use colours: as chosen; on kAuto only a terminal, and not when NO_COLOR holds anything or TERM
/// is `dumb`.
bool use_colour(ColourChoice choice, bool terminal,
                const std::function<std::optional<std::string>(const std::string&)>& environment);

}  // namespace asip::cli
