// SPDX-License-Identifier: Apache-2.0
// Reads the answer of one DHT sensor at a time by the interrupt of its pin, while everything else goes on.
#pragma once

#include <stdint.h>

namespace asip {

class DhtPulses {
  public:
    // Lets go of the pin, at which the sensor begins to answer. Its interrupt stays, and is heard up to the
    // last bit; none comes from a pin that has no interrupt.
    static void start(uint8_t pin);

    // Whether all bits of the answer came, which are in bytes(), or none of them.
    static bool areComplete();
    static bool areNone();
    static const uint8_t* bytes();

    // The level of the pin may have changed: for the interrupt.
    static void onPinChange();
};

}  // namespace asip
