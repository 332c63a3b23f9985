// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
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

std::vector<Assignment> assignments(std::string_view text) {
    std::vector<Assignment> items;
    while (!text.empty()) {
        const auto item = text.substr(0, text.find(','));
        text.remove_prefix(std::min(item.size() + 1, text.size()));
        const auto equals = std::min(item.find('='), item.size());
        items.push_back({item.substr(0, equals), item.substr(std::min(equals + 1, item.size()))});
    }
    return items;
}

std::string short_number(double value) {
    return fmt::format("{:.6g}", value);
}

}  // namespace asip::sim
