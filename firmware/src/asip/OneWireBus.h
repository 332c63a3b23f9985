// SPDX-License-Identifier: Apache-2.0
// A 1-Wire bus on one pin, which has to have a resistor of 4.7 kOhm to the supply:
//
//   asip::OneWireBus bus(2);
//
// A service starts a transfer or a search, and calls finish() in its poll() until it is over; each call does
// one bit at the most. Interrupts are off for 11 microseconds of a bit, so that no byte of the line is lost
// at 1,000,000 baud; a bit of 0 holds the loop up for 65, the beginning of a transfer for 100.
#pragma once

#include <stdint.h>

#include "Error.h"

namespace asip {

class Service;

class OneWireBus {
  public:
    // kNobody: no device answers. kShorted: the line is low for good, or has no resistor.
    enum Result : uint8_t { kFree, kBusy, kDone, kNobody, kShorted };

    // A bus has to be a global: what is not set here is zero.
    explicit OneWireBus(uint8_t pin) : pin_(pin) {}

    // Takes the pin, for all services of the bus: call when the service begins. False if the pin is in use
    // elsewhere: then nothing may be started.
    bool begin(const Service& service);

    // The same at any time.
    bool isAvailable() const;

    // Resets the bus, unless told not to, writes the `outCount` bytes of `bytes`, and then reads `inCount`
    // into it, each up to 16. They last until the end. False if the bus is busy.
    bool start(uint8_t* bytes, uint8_t outCount, uint8_t inCount, bool reset = true);

    // Finds a device and puts its id of eight bytes behind the first of `bytes`. With `branch` 0 it is the
    // first, and with the branch and the id that the last search left it is the next one; the branch is 0
    // behind the last.
    bool search(uint8_t* bytes, uint8_t branch);
    uint8_t branch() const { return newBranch_; }

    // How the transfer of the caller stands. Once it is over it is kDone, kNobody or kShorted once, and the
    // bus is free.
    Result finish();

    // 0 over bytes that end in their checksum.
    static uint8_t checksum(const uint8_t* bytes, uint8_t count);

  private:
    enum Phase : uint8_t { kIdle, kResetting, kPresence, kAbsence, kBits };

    bool waitWhile(bool high, uint8_t within) const;
    bool sawPresence() const;
    Result doBit();
    Result doSearchStep(uint8_t& byte);
    bool doSlot(bool bit);
    void hold(bool low);
    void pullDown() const;
    void release() const;
    bool isHigh() const;

    const Service* owner_;  // of the pin
    uint8_t* bytes_;
    uint16_t since_;  // microseconds
    uint8_t pin_;
    uint8_t phase_;
    uint8_t bit_;
    uint8_t outBits_, inBits_;  // outBits_ is 0 once they are written
    uint8_t step_;              // of a search, 0 of other transfers
    uint8_t branch_, newBranch_;
#ifdef __AVR__
    volatile uint8_t* input_;  // the register of the pin's direction is the next one
    uint8_t mask_;
#endif
};

}  // namespace asip
