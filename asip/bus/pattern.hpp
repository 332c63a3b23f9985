// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace asip::bus {

/// Whether the whole of `text` matches a pattern in which `*` stands for any text and `?` for any one byte.
/// An empty pattern matches everything. Takes time in proportion to both lengths multiplied at most, without
/// recursion.
bool matches_pattern(std::string_view pattern, std::string_view text);

}  // namespace asip::bus
