#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

namespace asip::protocol {

enum class PinMode : std::uint8_t {
    Unallocated = 0,
    Input = 1,
    InputPullup = 2,
    Output = 3,
    Analog = 4,
    Pwm = 5,
    Reserved = 6,
    OtherService = 7,
    Invalid = 8,
};

/// "unallocated", "input", "input-pullup", "output", "analog", "pwm", "reserved", "other-service", "invalid".
std::string_view to_text(PinMode mode);
/// By name (any case, `_` or `-`, also "pullup") or number; nothing when there is no such mode.
std::optional<PinMode> pin_mode_from_text(std::string_view text);
std::optional<PinMode> pin_mode_from_number(std::int64_t number);

/// Modes in which a pin's level appears in digital events.
constexpr bool is_digital_input(PinMode mode) {
    return mode == PinMode::Input || mode == PinMode::InputPullup;
}
/// Modes that `I,P` can ask for.
constexpr bool is_settable(PinMode mode) {
    return mode >= PinMode::Input && mode <= PinMode::Pwm;
}

/// Bits of a pin's capabilities, as `I,c` answers them.
inline constexpr std::uint8_t kCapabilityDigital = 1;
inline constexpr std::uint8_t kCapabilityAnalogIn = 2;
inline constexpr std::uint8_t kCapabilityPwm = 4;

/// "digital", "analog", "pwm" to its bit; nothing for other words.
std::optional<std::uint8_t> capability_from_text(std::string_view text);

}  // namespace asip::protocol
