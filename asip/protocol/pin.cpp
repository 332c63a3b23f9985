// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/pin.hpp"

#include <array>
#include <cctype>
#include <string>

#include "asip/protocol/body.hpp"

namespace asip::protocol {
namespace {

constexpr std::array<std::string_view, 9> kModes = {
    "unallocated", "input", "input-pullup", "output", "analog", "pwm", "reserved", "other-service", "invalid",
};

std::string normalised(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        c = c == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

}  // namespace

std::string_view to_text(PinMode mode) {
    const auto index = static_cast<std::size_t>(mode);
    return index < kModes.size() ? kModes[index] : kModes.back();
}

std::optional<PinMode> pin_mode_from_number(std::int64_t number) {
    if (number < 0 || number >= static_cast<std::int64_t>(kModes.size())) return std::nullopt;
    return static_cast<PinMode>(number);
}

std::optional<PinMode> pin_mode_from_text(std::string_view text) {
    if (const auto number = parse_integer(text)) return pin_mode_from_number(*number);
    const auto word = normalised(text);
    if (word == "pullup") return PinMode::kInputPullup;
    for (std::size_t i = 0; i < kModes.size(); ++i)
        if (kModes[i] == word) return static_cast<PinMode>(i);
    return std::nullopt;
}

}  // namespace asip::protocol
