// SPDX-License-Identifier: Apache-2.0
#include "cli/text/sparkline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

namespace asip::cli {

std::string sparkline(std::span<const double> values) {
    static constexpr std::array<std::string_view, 8> kBars{"\u2581", "\u2582", "\u2583", "\u2584",
                                                           "\u2585", "\u2586", "\u2587", "\u2588"};
    if (values.empty()) return {};
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double half = *high / 2 - *low / 2;  // the whole range may be no number
    std::string line;
    for (const double value : values) {
        const double part = half > 0 ? (value / 2 - *low / 2) / half : 0;
        line += kBars[static_cast<std::size_t>(std::lround(part * (kBars.size() - 1)))];
    }
    return line;
}

std::optional<double> first_number(const nlohmann::json& value) {
    if (value.is_number()) return value.get<double>();
    if (!value.is_structured()) return std::nullopt;
    for (const auto& part : value) {
        if (const auto found = first_number(part)) return found;
    }
    return std::nullopt;
}

}  // namespace asip::cli
