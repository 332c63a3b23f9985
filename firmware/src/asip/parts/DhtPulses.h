// SPDX-License-Identifier: Apache-2.0
// Reads the answer of one DHT sensor at a time by the interrupt of its pin, while everything else goes on.
#pragma once

#include <stdint.h>

namespace asip {

class DhtPulses {
  public:
    static constexpr uint8_t kBits = 40;

    // False if the pin has no interrupt. Lets go of the pin, at which the sensor begins to answer.
    static bool start(uint8_t pin);

    // How many bits came so far, up to kBits. Complete ones are in bytes().
    static uint8_t bits();
    static const uint8_t* bytes();

    // Listens no more.
    static void stop(uint8_t pin);

    // The level of the pin may have changed: for the interrupt.
    static void onPinChange();
};

}  // namespace asip
