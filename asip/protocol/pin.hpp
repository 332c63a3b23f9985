// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

namespace asip::protocol {

/// The mode of a digital pin, with its number on the wire.
enum class PinMode : std::uint8_t {
    kUnallocated = 0,
    kInput = 1,
    kInputPullup = 2,
    kOutput = 3,
    kAnalog = 4,
    kPwm = 5,
    kReserved = 6,      ///< by the system: the serial line, for example
    kOtherService = 7,  ///< another service than I has it
    kInvalid = 8,       ///< a number that this version does not know
};

/// The word for people and for JSON: "unallocated", "input", "input-pullup", "output", "analog", "pwm",
/// "reserved", "other-service", "invalid".
std::string_view to_text(PinMode mode);
/// From its word (any case, `_` or `-`, also "pullup") or its number as text. Nothing when there is no such
/// mode.
std::optional<PinMode> pin_mode_from_text(std::string_view text);
/// From its number, 0 to 8. Nothing for others.
std::optional<PinMode> pin_mode_from_number(std::int64_t number);

/// Whether a pin in this mode is one whose level appears in digital events.
constexpr bool is_digital_input(PinMode mode) {
    return mode == PinMode::kInput || mode == PinMode::kInputPullup;
}
/// Whether `I,P` can ask for this mode.
constexpr bool is_settable(PinMode mode) {
    return mode >= PinMode::kInput && mode <= PinMode::kPwm;
}

/// Bits of a pin's capabilities, as `I,c` answers them.
inline constexpr std::uint8_t kCapabilityDigital = 1;
inline constexpr std::uint8_t kCapabilityAnalogIn = 2;
inline constexpr std::uint8_t kCapabilityPwm = 4;

}  // namespace asip::protocol
