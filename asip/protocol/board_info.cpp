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

/// How many bytes the character of UTF-8 at the beginning has; 0: there is none, or one that is not shown.
std::size_t character_bytes(std::string_view text) {
    const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    if (first < 0x80) return first < 0x20 || first == 0x7f ? 0 : 1;
    const std::size_t bytes = first >= 0xf0 && first < 0xf5   ? 4
                              : first >= 0xe0 && first < 0xf0 ? 3
                              : first >= 0xc2 && first < 0xe0 ? 2
                                                              : 0;
    if (bytes == 0 || text.size() < bytes) return 0;
    unsigned point = first & (0x7fu >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return 0;
        point = point << 6 | (byte(i) & 0x3fu);
    }
    const bool overlong = point < (bytes == 2   ? 0xa0u
                                   : bytes == 3 ? 0x800u
                                                : 0x10000u);  // and U+0080 to U+009F
    return overlong || (point >= 0xd800 && point < 0xe000) || point > 0x10ffff ? 0 : bytes;
}

}  // namespace

std::string readable_name(std::string_view name) {
    std::string result;
    while (!name.empty()) {
        const auto bytes = character_bytes(name);
        bytes == 0 ? result += '?' : result.append(name.substr(0, bytes));
        name.remove_prefix(bytes == 0 ? 1 : bytes);
    }
    return result;
}

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
        info.sketch = readable_name(body.substr(static_cast<std::size_t>(fields[4].data() - body.data())));
    return info;
}

Expected<std::vector<ServiceName>> parse_service_names(std::string_view body) {
    const auto parsed = parse_body(body);
    if (!parsed) return fail(parsed.error());
    std::vector<ServiceName> names;
    for (const auto item : parsed->items) {
        if (item.empty() || item[0] < 'A' || item[0] > 'Z' || (item.size() > 1 && item[1] != ':'))
            return fail("service is not LETTER:NAME");
        names.push_back({item[0], readable_name(item.substr(item.size() > 1 ? 2 : 1))});
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
