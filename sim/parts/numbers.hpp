#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace asip::sim {

/// A decimal number that fills the whole text and is finite.
std::optional<double> parse_number(std::string_view text);

/// With up to six significant digits: "0.5", "90".
std::string short_number(double value);

}  // namespace asip::sim
