// SPDX-License-Identifier: Apache-2.0
// Makes the wave of a tone: with the Arduino core's tone(), or, on a chip without timer 2, with timer 1,
// which then goes on counting for the servos.
#pragma once

#include <stdint.h>

#include "asip/Hardware.h"

namespace asip {

class ToneTimer {
  public:
#if defined(TCCR2A) || !defined(__AVR__)
    static constexpr uint8_t kTimer = hw::kTimer2;
#else
    static constexpr uint8_t kTimer = hw::kTimer1;
#endif

    // Neither is 0; from 31 hertz on.
    static void start(uint8_t pin, uint16_t hertz, uint16_t milliseconds);
    static void stop(uint8_t pin);
};

}  // namespace asip
