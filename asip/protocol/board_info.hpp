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

/// `!SKETCH running on CHIP with Services: I D S `.
struct Banner {
    std::string sketch;
    std::string chip;
    std::string services;  // letters without spaces, "IDS"
};

/// From the text of an Info message (a leading `!` is allowed). Nothing when the text is no whole banner.
std::optional<Banner> parse_banner(std::string_view text);

/// Body of `@#,?`: `0,4,ATmega328P,20,AsipHello`.
struct BoardInfo {
    int major = 0;
    int minor = 0;
    std::string chip;
    int pins = 0;
    std::string sketch;  // may contain commas

    std::string protocol() const;  // "0.4"
};
Expected<BoardInfo> parse_board_info(std::string_view body);

/// One service of `@#,N`: `3,{I:ASIP core IO,S:Servos,D:Distance}`. The name is empty where the board gives
/// none.
struct ServiceName {
    char id;
    std::string name;
    friend bool operator==(const ServiceName&, const ServiceName&) = default;
};
Expected<std::vector<ServiceName>> parse_service_names(std::string_view body);

/// Body of `@#,S`: `20,{@,@,I,...}`. One character a pin: service letter, `@` system, `-` none or unreadable.
Expected<std::string> parse_pin_owners(std::string_view body);

/// Body of `@I,p`: `20,{6,6,1,...}`. Unknown numbers become PinMode::Invalid.
Expected<std::vector<PinMode>> parse_pin_modes(std::string_view body);

/// Body of `@I,c`: `20,{1,1,5,...}`, bits as in pin.hpp.
Expected<std::vector<std::uint8_t>> parse_pin_capabilities(std::string_view body);

/// Body of `@I,m`: `6,{14:0,15:1,...}` digital pin and its analog channel.
using AnalogMap = std::vector<std::pair<std::uint8_t, std::uint8_t>>;
Expected<AnalogMap> parse_analog_map(std::string_view body);

}  // namespace asip::protocol
