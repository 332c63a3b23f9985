// SPDX-License-Identifier: Apache-2.0
// Makes the pulses of up to eight servos with timer 1, one after the other in each frame of 20 ms.
#pragma once

#include <stdint.h>

namespace asip {

class ServoPulses {
  public:
    static constexpr uint8_t kMaxServos = 8;

    // Ends all pulses and forgets all servos.
    static void stop();

    // Adds a servo, without pulses yet; its pin is an output.
    static void add(uint8_t pin);

    static void setWidth(uint8_t servo, uint16_t halfMicroseconds);
};

}  // namespace asip
