#include "sim/parts/numbers.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace asip::sim {

std::optional<double> parse_number(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

std::string short_number(double value) {
    return fmt::format("{:.6g}", value);
}

}  // namespace asip::sim
