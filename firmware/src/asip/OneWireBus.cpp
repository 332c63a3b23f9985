// SPDX-License-Identifier: Apache-2.0
#include "OneWireBus.h"

#ifdef ARDUINO
#include <Arduino.h>

#include "Board.h"

namespace asip {

// From the data sheet of the DS18B20, in microseconds. A reset is a low of 480, behind which devices pull the
// line down for 60 to 240, at the latest after 60; nothing else happens for 480. A bit takes 60, and 1 until
// the next. It begins with a fall: 1 rises within 15, 0 after 60 to 120, and what a device sends has to be
// looked at within 15.
static constexpr uint16_t kReset = 485, kPresenceWithin = 100, kRise = 20, kSlot = 66;
static constexpr uint8_t kLow = 2, kLook = 7;
static constexpr uint8_t kSearchIds = 0xF0;

static uint16_t now() {
    return static_cast<uint16_t>(micros());
}

static uint16_t passedSince(uint16_t time) {
    return static_cast<uint16_t>(now() - time);
}

#ifdef __AVR__
void OneWireBus::pullDown() const {
    input_[1] |= mask_;
}
void OneWireBus::release() const {
    input_[1] &= static_cast<uint8_t>(~mask_);
}
bool OneWireBus::isHigh() const {
    return *input_ & mask_;
}
#else
void OneWireBus::pullDown() const {
    digitalWrite(pin_, LOW);
    pinMode(pin_, OUTPUT);
}
void OneWireBus::release() const {
    pinMode(pin_, INPUT);
}
bool OneWireBus::isHigh() const {
    return digitalRead(pin_) == HIGH;
}
#endif

bool OneWireBus::begin(const Service& service) {
    phase_ = kIdle;
    if (isAvailable()) return true;
    if (board.claimPin(pin_, service) != Error::kNone) return false;
    owner_ = &service;
    pinMode(pin_, INPUT);
#ifdef __AVR__
    input_ = portInputRegister(digitalPinToPort(pin_));
    mask_ = digitalPinToBitMask(pin_);
#endif
    return true;
}

bool OneWireBus::isAvailable() const {
    return owner_ != nullptr && board.ownsPin(pin_, *owner_);
}

// Holds the line low, or lets go of it, from now on.
void OneWireBus::hold(bool low) {
    noInterrupts();
    if (low) {
        pullDown();
    } else {
        release();
    }
    interrupts();
    since_ = now();
}

__attribute__((noinline)) bool OneWireBus::start(uint8_t* bytes, uint8_t outCount, uint8_t inCount,
                                                 bool reset) {
    if (phase_ != kIdle || passedSince(since_) < kSlot) return false;
    bytes_ = bytes;
    outBits_ = static_cast<uint8_t>(8 * outCount);
    inBits_ = static_cast<uint8_t>(8 * inCount);
    bit_ = step_ = 0;
    phase_ = kBits;
    if (reset) {
        phase_ = kResetting;
        hold(true);
    }
    return true;
}

bool OneWireBus::search(uint8_t* bytes, uint8_t branch) {
    bytes[0] = kSearchIds;
    if (!start(bytes, 1, 9)) return false;
    step_ = 1;
    branch_ = branch;
    newBranch_ = 0;
    return true;
}

bool OneWireBus::waitWhile(bool high, uint8_t within) const {
    while (isHigh() == high)
        if (passedSince(since_) > within) return false;
    return true;
}

// Whether a device says that it is there, just behind a reset. Its low lasts longer than any interrupt.
bool OneWireBus::sawPresence() const {
    return waitWhile(false, kRise) && waitWhile(true, kPresenceWithin);
}

__attribute__((noinline)) OneWireBus::Result OneWireBus::finish() {
    if (phase_ == kIdle) return kFree;
    if (passedSince(since_) < (phase_ == kBits ? kSlot : kReset)) return kBusy;
    Result result = kBusy;
    if (phase_ == kBits) {
        result = doBit();
    } else if (phase_ == kResetting) {
        hold(false);
        phase_ = sawPresence() ? kPresence : kAbsence;
    } else {
        if (!isHigh()) {
            result = kShorted;
        } else if (phase_ == kAbsence) {
            result = kNobody;
        }
        phase_ = kBits;
    }
    if (result != kBusy) phase_ = kIdle;
    return result;
}

static void shiftIn(uint8_t& byte, bool bit) {
    byte = static_cast<uint8_t>(byte / 2U);
    if (bit) byte |= 0x80;
}

// What is written stands at the beginning of the bytes, and what is read is put there; what a search finds
// stands behind its command.
OneWireBus::Result OneWireBus::doBit() {
    uint8_t& byte = bytes_[bit_ / 8];
    if (outBits_ == 0) {
        if (bit_ == inBits_) return kDone;
        if (step_ != 0) return doSearchStep(byte);
    }
    shiftIn(byte, doSlot(outBits_ == 0 || (byte & 1)));
    bit_ = static_cast<uint8_t>(bit_ + 1);
    if (bit_ == outBits_) {
        outBits_ = 0;
        if (step_ == 0) bit_ = 0;
    }
    return kBusy;
}

// Each bit of an id is sent by all devices that are still meant, as it is and turned over; then the one that
// goes on is written. Where both kinds of devices are there the way to 0 is gone first, and the last such
// place is the branch.
OneWireBus::Result OneWireBus::doSearchStep(uint8_t& byte) {
    uint8_t step = step_;  // 1, and the two bits behind it
    if (step < 4) {
        step = static_cast<uint8_t>(step << 1);
        if (doSlot(true)) ++step;
        step_ = step;
        return step == 7 ? kNobody : kBusy;
    }
    const uint8_t place = static_cast<uint8_t>(bit_ + 1);
    bool way = step & 2;
    if (step == 4) {
        way = place == branch_ || (place < branch_ && (byte & 1));
        if (!way) newBranch_ = place;
    }
    shiftIn(byte, way);
    doSlot(way);
    step_ = 1;
    bit_ = place;
    return kBusy;
}

// Writes a bit; to read one is to write 1. The look at the clock comes behind the fall: an interrupt between
// them makes the bit longer, not too short.
bool OneWireBus::doSlot(bool bit) {
    noInterrupts();
    pullDown();
    if (bit) {
        delayMicroseconds(kLow);
        release();
        delayMicroseconds(kLook);
        bit = isHigh();
        interrupts();
        since_ = now();
        return bit;
    }
    interrupts();
    const uint16_t since = now();
    while (passedSince(since) < kSlot) {
    }
    hold(false);
    since_ = since;
    return false;
}

// x^8 + x^5 + x^4 + 1, the lowest bit first.
uint8_t OneWireBus::checksum(const uint8_t* bytes, uint8_t count) {
    uint8_t sum = 0;
    for (; count > 0; --count) {
        sum ^= *bytes++;
        for (uint8_t i = 0; i < 8; ++i) {
            const bool isOdd = sum & 1;
            sum = static_cast<uint8_t>(sum / 2U);
            if (isOdd) sum ^= 0x8C;
        }
    }
    return sum;
}

}  // namespace asip

#endif
