// SPDX-License-Identifier: Apache-2.0
// The I2C bus of a chip that is not AVR, by Wire, which its Arduino core brings. The loop stands while a
// transfer lasts, some 0.1 ms a byte. The pins are those of Wire. If a sketch gives Wire other pins than SDA
// and SCL, it says so before it includes a service of the bus:
//
//   #define ASIP_SDA 12
//   #define ASIP_SCL 13
#pragma once

#include <Wire.h>  // the I2C bus, from the Arduino core

#include "I2c.h"

#ifndef ASIP_SDA
#define ASIP_SDA SDA
#define ASIP_SCL SCL
#endif

namespace asip {
namespace coreCheck {

template <typename Bus>
auto isBus(Bus* bus)
    -> decltype(bus->begin(), bus->beginTransmission(uint8_t()), bus->write(uint8_t()),
                bus->endTransmission(true), bus->requestFrom(uint8_t(), uint8_t()), bus->read(), true);
struct NoBus {
    char twoBytes[2];
};
NoBus isBus(...);
static_assert(sizeof(isBus(&Wire)) == sizeof(bool),
              "Asip needs Wire with begin(), beginTransmission(address), write(byte), endTransmission(stop), "
              "requestFrom(address, count) and read(), for services on I2C: this Arduino core lacks one");

}  // namespace coreCheck

namespace wire {

inline bool transfer(uint8_t address, uint8_t first, const uint8_t* out, uint8_t outCount, uint8_t* in,
                     uint8_t inCount) {
    if (!(address & I2c::kNoFirst)) {
        Wire.beginTransmission(address);
        Wire.write(first);
        for (; outCount > 0; --outCount)
            Wire.write(*out++);
        if (Wire.endTransmission(inCount == 0) != 0) return false;
    }
    address &= static_cast<uint8_t>(~I2c::kNoFirst);
    if (inCount == 0) return true;
    if (Wire.requestFrom(address, inCount) != inCount) return false;
    for (; inCount > 0; --inCount)
        *in++ = static_cast<uint8_t>(Wire.read());
    return true;
}

inline I2c::Fault faultOf(uint8_t result) {
    switch (result) {
        case 0:
            return I2c::kNoFault;
        case 1:
            return I2c::kTooLong;
        case 2:
            return I2c::kNoAddress;
        case 3:
            return I2c::kNoData;
        default:
            return I2c::kTooSlow;
    }
}

// What the part before left behind.
struct Open {
    bool isWriting;  // Wire has bytes that are not sent yet
    bool isKept;     // the bus waits for a STOP
    uint8_t chip;
};

inline Open& open() {
    static Open one;
    return one;
}

// A Wire that runs ignores another begin().
inline void begin() {
#ifdef WIRE_HAS_END
    static bool runs;
    if (runs) Wire.end();
    runs = true;
#endif
    Wire.begin();
    open() = Open();
}

inline I2c::Fault read(uint8_t way, uint8_t address, uint8_t* bytes, uint8_t count) {
    const bool stops = way & I2c::kStop;
    open().isKept = !stops;
    if (Wire.requestFrom(static_cast<int>(address), static_cast<int>(count), static_cast<int>(stops)) !=
        count)
        return I2c::kNoAddress;
    for (; count > 0; --count)
        *bytes++ = static_cast<uint8_t>(Wire.read());
    return I2c::kNoFault;
}

inline I2c::Fault write(uint8_t way, uint8_t address, const uint8_t* bytes, uint8_t count) {
    if (!(way & I2c::kGoOn)) Wire.beginTransmission(address);
    for (; count > 0; --count) {
        if (Wire.write(*bytes++) == 1) continue;
        open().isWriting = false;
        return I2c::kTooLong;
    }
    open().isWriting = (way & I2c::kStop) == 0;
    if (open().isWriting) return I2c::kNoFault;
    open().isKept = false;
    return faultOf(Wire.endTransmission(true));
}

// Wire sends what it was given when the transfer ends or turns, so only then it tells a fault; and it takes
// as many bytes as its buffer holds. It reads no part that another one goes on with.
inline I2c::Fault part(uint8_t way, uint8_t address, uint8_t* bytes, uint8_t count) {
    Open& left = open();
    const bool reads = way & I2c::kRead, goesOn = way & I2c::kGoOn;
    const bool isTooLong = reads && (goesOn || (way & I2c::kMore));
    I2c::Fault fault = I2c::kNoFault;
    if (left.isWriting && !goesOn) {
        left.isWriting = false;
        left.isKept = way != 0 && !isTooLong;
        fault = faultOf(Wire.endTransmission(!left.isKept));
    }
    if (fault == I2c::kNoFault && isTooLong) fault = I2c::kTooLong;
    if (fault == I2c::kNoFault && way != 0) {
        left.chip = address;
        fault = reads ? read(way, address, bytes, count) : write(way, address, bytes, count);
    }
    if (left.isKept && (fault != I2c::kNoFault || way == 0)) {
        // Wire makes a STOP behind an address only.
        left.isKept = false;
        Wire.beginTransmission(left.chip);
        Wire.endTransmission(true);
    }
    return fault;
}

__attribute__((unused)) static const bool isUsed = I2c::use(begin, transfer, part, ASIP_SDA, ASIP_SCL);

}  // namespace wire
}  // namespace asip
