// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace asip::sim {

/// A decimal number that fills the whole text and is finite.
std::optional<double> parse_number(std::string_view text);

/// With up to six significant digits: "0.5", "90".
std::string short_number(double value);

/// NAME and VALUE of one item of "NAME=VALUE,..."; the value is empty where there is no "=".
struct Assignment {
    std::string_view name, value;
};
/// The items of such a text, which they refer to.
std::vector<Assignment> assignments(std::string_view text);

}  // namespace asip::sim
