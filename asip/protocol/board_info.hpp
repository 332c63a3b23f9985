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

/// A user's name, fit to be shown: what is no UTF-8, and control characters, become `?`.
std::string readable_name(std::string_view name);

/// `!SKETCH running on CHIP with Services: I D S `, sent at a start. The texts are the board's: escape them.
struct Banner {
    std::string sketch;
    std::string chip;
    std::string services;  ///< letters without spaces, "IDS"
};

/// From an Info message (a leading `!` is allowed). Nothing: no whole banner, or a service that is no letter.
std::optional<Banner> parse_banner(std::string_view text);

/// The answer to `#,?`: `0,4,ATmega328P,20,AsipHello`.
struct BoardInfo {
    int major = 0;  ///< version of the protocol
    int minor = 0;
    std::string chip;
    int pins = 0;        ///< number of digital pins, 0 to kMaxPins
    std::string sketch;  ///< may contain commas

    /// "0.4".
    std::string protocol() const;
};
/// Fails, as all functions below, with a reason for a person on a damaged line.
Expected<BoardInfo> parse_board_info(std::string_view body);

/// From the answer to `#,N`: `3,{I:ASIP core IO,S:Servos,D:Distance}`.
struct ServiceName {
    char id;           ///< its letter, A to Z
    std::string name;  ///< for a person; empty where the board gives none
    friend bool operator==(const ServiceName&, const ServiceName&) = default;
};
Expected<std::vector<ServiceName>> parse_service_names(std::string_view body);

/// From the answer to `#,S`: `20,{@,@,I,...}`. A character for each pin: the letter of its service, `@` for
/// the system, `-` for none or an unreadable one.
Expected<std::string> parse_pin_owners(std::string_view body);

/// From the answer to `I,p`: `20,{6,6,1,...}`, by pin. Unknown numbers become PinMode::kInvalid.
Expected<std::vector<PinMode>> parse_pin_modes(std::string_view body);

/// From the answer to `I,c`: `20,{1,1,5,...}`, sums of kCapability... bits by pin.
Expected<std::vector<std::uint8_t>> parse_pin_capabilities(std::string_view body);

/// From the answer to `I,m`: `6,{14:0,15:1,...}`, pins and their analog channels.
using AnalogMap = std::vector<std::pair<std::uint8_t, std::uint8_t>>;
Expected<AnalogMap> parse_analog_map(std::string_view body);

}  // namespace asip::protocol
