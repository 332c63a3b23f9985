// SPDX-License-Identifier: Apache-2.0
// The I2C bus at 100 kHz: a service starts a transfer, goes on, and looks in poll() whether it is over. One
// transfer at a time; a service that finds the bus busy tries again in the next pass. An AVR does a transfer
// by interrupts. On other chips the core's Wire does it (I2cWire.h), and start() waits for its end.
#pragma once

#include <stdint.h>

#include "Error.h"

namespace asip {

class Service;

class I2c {
  public:
    // A chip that does not acknowledge, or a bus that does not move for 25 ms (on chips that are not AVR, for
    // as long as the core waits), ends as kFailed.
    enum Result : uint8_t { kFree, kBusy, kDone, kFailed, kKept };

    // Takes the pins of the bus for all I2C services: call when the service begins. kI2cNotEnabled if one of
    // them is in use by another service.
    static Error begin(const Service& service);

    // True if the bus has its pins.
    static bool isEnabled();

    // Writes `first` and the `outCount` bytes of `out` to the chip at `address` (seven bits), then, if
    // `inCount` is not 0, reads as many into `in`. Both last until the end of the transfer. False if the bus
    // is busy. With kNoFirst added to the address it only reads.
    static constexpr uint8_t kNoFirst = 0x80;
    static bool start(uint8_t address, uint8_t first, const uint8_t* out, uint8_t outCount, uint8_t* in,
                      uint8_t inCount);

    // How the transfer of the caller stands. Once it is over it is kDone or kFailed once, and the bus is
    // free.
    static Result finish();

    // For the one service that reaches any chip: transfers in parts. Between two of them the bus is kept,
    // and no other transfer begins.
    enum Way : uint8_t {
        kRead = 1,   // else it writes
        kGoOn = 2,   // goes on where the part before, the same way, ended; else it begins with a START
        kMore = 4,   // of a part that reads: the next one goes on
        kStop = 8,   // it ends with a STOP, and the bus is free
        kParts = 16  // always
    };
    enum Fault : uint8_t { kNoFault, kNoAddress, kNoData, kHeldLow, kTooSlow, kTooLong };

    // As start(), for a part. A part that reads has a byte at least, one that goes on too.
    static bool startPart(uint8_t way, uint8_t address, uint8_t* bytes, uint8_t count);

    // kBusy, or how the part ended: once. A part that failed has freed the bus.
    static Result finishPart();
    static Fault fault();

    // Frees the bus, where it is kept. On chips that are not AVR only this tells the fault of a last write.
    static Fault endParts();

#ifndef __AVR__
    typedef void (*Begin)();
    typedef bool (*Transfer)(uint8_t address, uint8_t first, const uint8_t* out, uint8_t outCount,
                             uint8_t* in, uint8_t inCount);
    typedef Fault (*Part)(uint8_t way, uint8_t address, uint8_t* bytes, uint8_t count);

    // What does the transfers, and its pins: before any service begins. `begin` is called again when the
    // pins were used otherwise. `part` with the way 0 ends what is open.
    static bool use(Begin begin, Transfer transfer, Part part, uint8_t dataPin, uint8_t clockPin);
#endif
};

}  // namespace asip

// A sketch with an I2C service brings the core's Wire, the library's own sources do not: so a sketch without
// such a service has no Wire.
#if defined(ARDUINO) && !defined(__AVR__) && !defined(ASIP_LIBRARY_SOURCE)
#include "I2cWire.h"
#endif
