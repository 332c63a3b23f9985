// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace asip::bus {

/// `*` stands for any text, `?` for any byte; an empty pattern matches everything. Takes time in proportion
/// to the product of both lengths, without recursion.
bool matches_pattern(std::string_view pattern, std::string_view text);

}  // namespace asip::bus
