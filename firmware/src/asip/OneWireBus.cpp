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

void OneWireBus::begin(const Service& service) {
    phase_ = kIdle;
    if (isAvailable() || board.claimPin(pin_, service) != Error::kNone) return;
    owner_ = &service;
    pinMode(pin_, INPUT);
#ifdef __AVR__
    input_ = portInputRegister(digitalPinToPort(pin_));
    mask_ = digitalPinToBitMask(pin_);
#endif
}

bool OneWireBus::isAvailable() const {
    return owner_ != nullptr && board.ownsPin(pin_, *owner_);
}

// The last bit is over, too.
bool OneWireBus::isFree() const {
    return phase_ == kIdle && isAvailable() && passedSince(since_) >= kSlot;
}

bool OneWireBus::begin(Phase phase) {
    bit_ = step_ = 0;
    next_ = phase;
    phase_ = kResetting;
    noInterrupts();
    pullDown();
    interrupts();
    since_ = now();
    return true;
}

bool OneWireBus::start(uint8_t* bytes, uint8_t outCount, uint8_t inCount, bool reset) {
    if (!isFree()) return false;
    bytes_ = bytes;
    outBits_ = static_cast<uint8_t>(8 * outCount);
    inBits_ = static_cast<uint8_t>(8 * inCount);
    if (reset) return begin(kBits);
    bit_ = 0;
    phase_ = kBits;
    return true;
}

bool OneWireBus::search(uint8_t* id, uint8_t branch) {
    if (!isFree()) return false;
    bytes_ = id;
    branch_ = branch;
    newBranch_ = 0;
    return begin(kSearchCommand);
}

// Whether a device says that it is there, just behind a reset. Its low lasts longer than any interrupt.
bool OneWireBus::sawPresence() const {
    while (!isHigh())
        if (passedSince(since_) > kRise) return false;
    while (isHigh())
        if (passedSince(since_) > kPresenceWithin) return false;
    return true;
}

OneWireBus::Result OneWireBus::finish() {
    Result result = kBusy;
    const uint16_t passed = passedSince(since_);
    switch (phase_) {
        case kResetting:
            if (passed < kReset) return kBusy;
            noInterrupts();
            release();
            interrupts();
            since_ = now();
            step_ = sawPresence();
            phase_ = kPresence;
            return kBusy;
        case kPresence:
            if (passed < kReset) return kBusy;
            if (!isHigh()) {
                result = kShorted;
            } else if (step_ == 0) {
                result = kNobody;
            }
            phase_ = next_;
            step_ = 0;
            break;
        case kBits:
            if (passed < kSlot) return kBusy;
            result = doBit();
            break;
        case kSearchCommand:
            if (passed < kSlot) return kBusy;
            write(kSearchIds >> bit_ & 1);
            bit_ = static_cast<uint8_t>(bit_ + 1);
            if (bit_ < 8) return kBusy;
            bit_ = 0;
            phase_ = kSearching;
            return kBusy;
        case kSearching:
            if (passed < kSlot) return kBusy;
            result = doSearchStep();
            break;
        default:
            return kFree;
    }
    if (result != kBusy) phase_ = kIdle;
    return result;
}

// What is written stands at the beginning of the bytes, and what is read is put there.
OneWireBus::Result OneWireBus::doBit() {
    uint8_t& byte = bytes_[bit_ / 8];
    if (outBits_ != 0) {
        write(byte >> bit_ % 8 & 1);
        bit_ = static_cast<uint8_t>(bit_ + 1);
        if (bit_ == outBits_) outBits_ = bit_ = 0;
        return kBusy;
    }
    if (bit_ == inBits_) return kDone;
    bit_ = static_cast<uint8_t>(bit_ + 1);
    byte = static_cast<uint8_t>(byte >> 1 | (read() ? 0x80 : 0));
    return kBusy;
}

// Each bit of an id is sent by all devices that are still meant, as it is and turned over; then the one that
// goes on is written. Where both kinds of devices are there the way to 0 is gone first, and the last such
// place is the branch.
OneWireBus::Result OneWireBus::doSearchStep() {
    if (bit_ == 64) return kDone;
    const uint8_t which = step_ & 3;
    if (which < 2) {
        // The two bits are kept above the count.
        step_ = static_cast<uint8_t>((step_ + 1) | (read() ? 0x80 >> which : 0));
        return step_ == (0xC0 | 2) ? kNobody : kBusy;
    }
    uint8_t& byte = bytes_[bit_ / 8];
    const uint8_t mask = static_cast<uint8_t>(1 << bit_ % 8);
    const uint8_t place = static_cast<uint8_t>(bit_ + 1);
    bool way = step_ & 0x80;
    if ((step_ & 0xc0) == 0) {
        way = place == branch_ || (place < branch_ && (byte & mask));
        if (!way) newBranch_ = place;
    }
    byte = static_cast<uint8_t>(way ? byte | mask : byte & ~mask);
    write(way);
    step_ = 0;
    bit_ = place;
    return kBusy;
}

// The look at the clock comes behind the fall: an interrupt between them makes the bit longer, not too short.
void OneWireBus::write(bool bit) {
    noInterrupts();
    pullDown();
    if (bit) {
        delayMicroseconds(kLow);
        release();
    }
    interrupts();
    since_ = now();
    if (bit) return;
    while (passedSince(since_) < kSlot) {
    }
    noInterrupts();
    release();
    interrupts();
}

bool OneWireBus::read() {
    noInterrupts();
    pullDown();
    delayMicroseconds(kLow);
    release();
    delayMicroseconds(kLook);
    const bool bit = isHigh();
    interrupts();
    since_ = now();
    return bit;
}

// x^8 + x^5 + x^4 + 1, the lowest bit first.
uint8_t OneWireBus::checksum(const uint8_t* bytes, uint8_t count) {
    uint8_t sum = 0;
    for (; count > 0; --count) {
        sum ^= *bytes++;
        for (uint8_t i = 0; i < 8; ++i)
            sum = static_cast<uint8_t>(sum & 1 ? sum >> 1 ^ 0x8C : sum >> 1);
    }
    return sum;
}

}  // namespace asip

#endif
