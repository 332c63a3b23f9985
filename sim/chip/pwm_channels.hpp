// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string_view>

namespace asip::sim {

/// As addresses in the data space.
struct PwmChannel {
    int pin;
    std::uint16_t control;   ///< TCCRnA
    std::uint8_t connected;  ///< its COM bits of this channel: not 0 while the timer has the pin
    std::uint16_t compare;   ///< low byte of OCRnx; the Arduino core uses 8 bits everywhere
};

/// Null: none.
const PwmChannel* find_pwm_channel(std::string_view board, int pin);

}  // namespace asip::sim
