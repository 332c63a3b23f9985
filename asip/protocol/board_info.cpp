// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/board_info.hpp"

#include "asip/protocol/body.hpp"
#include "asip/protocol/limits.hpp"

namespace asip::protocol {
namespace {

/// A number from 0 to `max`, or nothing.
std::optional<int> small_number(std::string_view text, int max) {
    const auto number = parse_integer(text);
    if (!number || *number < 0 || *number > max) return std::nullopt;
    return static_cast<int>(*number);
}

}  // namespace

std::string BoardInfo::protocol() const {
    return std::to_string(major) + "." + std::to_string(minor);
}

Expected<BoardInfo> parse_board_info(std::string_view body) {
    const auto fields = split_fields(body, ',');
    if (fields.size() < 4) return fail("board information has fewer than four fields");
    const auto major = small_number(fields[0], 255);
    const auto minor = small_number(fields[1], 255);
    if (!major || !minor) return fail("board information has no version");
    if (fields[2].empty()) return fail("board information names no chip");
    const auto pins = small_number(fields[3], static_cast<int>(kMaxPins));
    if (!pins) return fail("board information has no number of pins up to 256");
    BoardInfo info{*major, *minor, std::string(fields[2]), *pins, {}};
    if (fields.size() > 4)
        info.sketch = body.substr(static_cast<std::size_t>(fields[4].data() - body.data()));
    return info;
}

Expected<std::vector<ServiceName>> parse_service_names(std::string_view body) {
    const auto parsed = parse_body(body);
    if (!parsed) return fail(parsed.error());
    std::vector<ServiceName> names;
    for (const auto item : parsed->items) {
        if (item.empty() || item[0] < 'A' || item[0] > 'Z' || (item.size() > 1 && item[1] != ':')) {
            return fail("service is not LETTER:NAME");
        }
        names.push_back({item[0], std::string(item.substr(item.size() > 1 ? 2 : 1))});
    }
    return names;
}

Expected<std::string> parse_pin_owners(std::string_view body) {
    const auto parsed = parse_body(body);
    if (!parsed) return fail(parsed.error());
    std::string owners;
    for (const auto item : parsed->items) {
        const bool known = item.size() == 1 && (item[0] == '@' || (item[0] >= 'A' && item[0] <= 'Z'));
        owners += known ? item[0] : '-';
    }
    return owners;
}

Expected<std::vector<PinMode>> parse_pin_modes(std::string_view body) {
    const auto parsed = parse_body(body);
    if (!parsed) return fail(parsed.error());
    std::vector<PinMode> modes;
    for (const auto item : parsed->items) {
        const auto number = parse_integer(item);
        if (!number) return fail("pin mode is not a number");
        modes.push_back(pin_mode_from_number(*number).value_or(PinMode::kInvalid));
    }
    return modes;
}

Expected<std::vector<std::uint8_t>> parse_pin_capabilities(std::string_view body) {
    const auto parsed = parse_body(body);
    if (!parsed) return fail(parsed.error());
    constexpr int kAllBits = kCapabilityDigital | kCapabilityAnalogIn | kCapabilityPwm;
    std::vector<std::uint8_t> capabilities;
    for (const auto item : parsed->items) {
        const auto bits = small_number(item, 255);
        if (!bits) return fail("a pin capability is not a number");
        capabilities.push_back(static_cast<std::uint8_t>(*bits & kAllBits));
    }
    return capabilities;
}

Expected<AnalogMap> parse_analog_map(std::string_view body) {
    const auto parsed = parse_body(body);
    if (!parsed) return fail(parsed.error());
    AnalogMap map;
    for (const auto item : parsed->items) {
        const auto fields = split_fields(item);
        if (fields.size() != 2) return fail("analog map item is not PIN:CHANNEL");
        const auto pin = small_number(fields[0], 255);
        const auto channel = small_number(fields[1], 255);
        if (!pin || !channel) return fail("analog map item is not PIN:CHANNEL");
        map.emplace_back(static_cast<std::uint8_t>(*pin), static_cast<std::uint8_t>(*channel));
    }
    return map;
}

}  // namespace asip::protocol
