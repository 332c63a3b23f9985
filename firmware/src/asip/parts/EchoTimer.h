// SPDX-License-Identifier: Apache-2.0
// Times the echo of one ultrasonic sensor at a time, while everything else goes on. The echo is timed by the
// pin-change interrupt where its pin has one, else by finished(), to within the time between two calls.
#pragma once

#include <stdint.h>

namespace asip {

class EchoTimer {
  public:
    // Triggers the sensor on `pin`, as soon as it is quiet.
    static void start(uint8_t pin);
    static void stop();

    // To be called in each pass. True once the echo is over, with its length, or after 25 ms without one,
    // with 0.
    static bool finished(uint16_t& microseconds);

    // The level of the pin may have changed: for the interrupt.
    static void onPinChange();
};

}  // namespace asip
