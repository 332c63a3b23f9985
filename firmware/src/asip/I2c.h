// SPDX-License-Identifier: Apache-2.0
// The I2C bus of an AVR at 100 kHz, by interrupts: a service starts a transfer, goes on, and looks in poll()
// whether it is over. One transfer at a time; who finds the bus busy tries again in the next pass.
#pragma once

#include <stdint.h>

#include "Error.h"

namespace asip {

class Service;

class I2c {
  public:
    // A chip that does not acknowledge, or a bus that does not move for 25 ms, ends as kFailed.
    enum Result : uint8_t { kFree, kBusy, kDone, kFailed };

    // Takes the pins of the bus for all I2C services: call when the service begins. kI2cNotEnabled if one of
    // them is in use by another service.
    static Error begin(const Service& service);

    // True if the bus has its pins.
    static bool isEnabled();

    // Writes `first` and the `outCount` bytes of `out` to the chip at `address` (seven bits), then, if
    // `inCount` is not 0, reads as many into `in`. Both last until the end of the transfer. False if the bus
    // is busy.
    static bool start(uint8_t address, uint8_t first, const uint8_t* out, uint8_t outCount, uint8_t* in,
                      uint8_t inCount);

    // Of the transfer that the caller started. Once it is over it is kDone or kFailed once, and the bus is
    // free.
    static Result finish();
};

}  // namespace asip
