// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/expected.hpp"
#include "asip/protocol/pin.hpp"

namespace asip::protocol {

/// A name that a user gave, fit to be shown: characters of UTF-8 stay, what is none becomes `?`, and so do
/// control characters.
std::string readable_name(std::string_view name);

/// What a board sends once when it starts: `!SKETCH running on CHIP with Services: I D S `. All texts are as
/// the board sent them, so escape them before they are shown.
struct Banner {
    std::string sketch;
    std::string chip;
    std::string services;  ///< letters without spaces, "IDS"
};

/// From the text of an Info message (a leading `!` is allowed). Nothing when the text is not a whole banner,
/// for example because its beginning was lost, or names a service by something else than a letter A to Z.
std::optional<Banner> parse_banner(std::string_view text);

/// What a board answers to `#,?`: the body `0,4,ATmega328P,20,AsipHello`.
struct BoardInfo {
    int major = 0;  ///< version of the protocol
    int minor = 0;
    std::string chip;
    int pins = 0;        ///< number of digital pins, 0 to kMaxPins
    std::string sketch;  ///< may contain commas

    /// The version as text: "0.4".
    std::string protocol() const;
};
/// Fails, as do all functions below, with a reason for a person when the body is cut off, has a count that is
/// not the number of its items, or holds something that is not what it must be: a damaged line.
Expected<BoardInfo> parse_board_info(std::string_view body);

/// One service of the answer to `#,N`: `3,{I:ASIP core IO,S:Servos,D:Distance}`.
struct ServiceName {
    char id;           ///< its letter, A to Z
    std::string name;  ///< for a person; empty where the board gives none
    friend bool operator==(const ServiceName&, const ServiceName&) = default;
};
Expected<std::vector<ServiceName>> parse_service_names(std::string_view body);

/// What a board answers to `#,S`: `20,{@,@,I,...}`. The result has one character for each pin, from pin 0 on:
/// the letter of the service that has it, `@` for the system, `-` for none or one that cannot be read.
Expected<std::string> parse_pin_owners(std::string_view body);

/// What a board answers to `I,p`: `20,{6,6,1,...}`, one mode for each pin from pin 0 on. Unknown numbers
/// become PinMode::kInvalid.
Expected<std::vector<PinMode>> parse_pin_modes(std::string_view body);

/// What a board answers to `I,c`: `20,{1,1,5,...}`, for each pin the sum of its kCapability... bits
/// (pin.hpp).
Expected<std::vector<std::uint8_t>> parse_pin_capabilities(std::string_view body);

/// What a board answers to `I,m`: `6,{14:0,15:1,...}`, pairs of a digital pin and its analog channel, in the
/// board's order.
using AnalogMap = std::vector<std::pair<std::uint8_t, std::uint8_t>>;
Expected<AnalogMap> parse_analog_map(std::string_view body);

}  // namespace asip::protocol
