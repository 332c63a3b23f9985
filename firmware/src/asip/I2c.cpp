// SPDX-License-Identifier: Apache-2.0
#define ASIP_LIBRARY_SOURCE
#include "I2c.h"

#ifdef __AVR__
#include <Arduino.h>
#include <avr/interrupt.h>

#include "Board.h"

namespace asip {

static constexpr uint32_t kHertz = 100000;
static constexpr uint8_t kTimeoutMs = 25;

static constexpr uint8_t kGo = (1 << TWINT) | (1 << TWEN) | (1 << TWIE);
static constexpr uint8_t kStop = (1 << TWINT) | (1 << TWEN) | (1 << TWSTO);
static constexpr uint8_t kKeep = 1 << TWEN;                  // the clock stays low
static constexpr uint8_t kLast = (1 << TWEN) | (1 << TWIE);  // the interrupt before kKeep comes again
static constexpr uint8_t kNothing = 0xF8;                    // a status: nothing happened yet
static constexpr uint8_t kReadMore = 0x50;                   // a byte was read and acknowledged

// The transfer under way.
static volatile uint8_t result;
static uint8_t address, firstByte, left, startedMs;
static uint8_t* next;
static uint8_t* readTo;

// Where no service transfers in parts, or none does otherwise, the first or the last are never written, and
// compiled as the constants that they are.
static uint8_t readCount;                   // bytes of a whole transfer to read, and 1
static uint8_t part;                        // its Way; 0: a whole transfer
static volatile uint8_t status = kNothing;  // the last of the TWI in a part

static const Service* owner;  // of the pins

// Whatever was under way is over. A chip that was interrupted while it sent holds SDA low until it got the
// clocks of its byte.
static void freeBus() {
    TWCR = 0;
    pinMode(SDA, INPUT_PULLUP);
    for (uint8_t clocks = 9;; --clocks) {
        pinMode(SCL, INPUT_PULLUP);
        delayMicroseconds(5);
        if (clocks == 0 || (hw::readPort(hw::portOf(SDA)) & hw::maskOf(SDA))) break;
        pinMode(SCL, OUTPUT);
        digitalWrite(SCL, LOW);
        delayMicroseconds(5);
    }
    TWBR = static_cast<uint8_t>((F_CPU / kHertz - 16) / 2);
    TWCR = kStop;
    result = I2c::kFree;
}

Error I2c::begin(const Service& service) {
    if (isEnabled()) return Error::kNone;
    if (!board.canClaim(SCL, service) || board.claimPin(SDA, service) != Error::kNone)
        return Error::kI2cNotEnabled;
    board.claimPin(SCL, service);
    owner = &service;
    hw::busPinsTaken = true;
    freeBus();
    return Error::kNone;
}

bool I2c::isEnabled() {
    return owner != nullptr && board.ownsPin(SDA, *owner);
}

bool I2c::start(uint8_t chip, uint8_t first, const uint8_t* out, uint8_t outCount, uint8_t* in,
                uint8_t inCount) {
    if (result != kFree || !isEnabled()) return false;
    address = static_cast<uint8_t>(chip << 1 | chip >> 7);
    firstByte = first;
    next = const_cast<uint8_t*>(out);
    left = outCount;
    readTo = in;
    readCount = static_cast<uint8_t>(inCount + 1);
    startedMs = hw::milliseconds();
    result = kBusy;
    TWCR = static_cast<uint8_t>(kGo | (1 << TWSTA) | (TWCR & (1 << TWSTO)));
    return true;
}

I2c::Result I2c::finish() {
    const uint8_t now = result;
    if (now == kBusy) {
        if (static_cast<uint8_t>(hw::milliseconds() - startedMs) < kTimeoutMs) return kBusy;
        freeBus();
        return kFailed;
    }
    result = kFree;
    return static_cast<Result>(now);
}

__attribute__((always_inline)) static inline uint8_t writeOn() {
    --left;
    TWDR = *next++;
    return kGo;
}

// The last byte is not acknowledged, unless another part goes on.
__attribute__((always_inline)) static inline uint8_t readOn() {
    return left > 1 || (part & I2c::kMore) ? kGo | (1 << TWEA) : kGo;
}

// As start(): the address says which way, also behind a repeated START.
bool I2c::startPart(uint8_t way, uint8_t chip, uint8_t* bytes, uint8_t count) {
    if (result != kFree && result != kKept) return false;
    part = static_cast<uint8_t>(way | kParts);
    next = bytes;
    left = count;
    startedMs = hw::milliseconds();
    status = 0;
    result = kBusy;
    if (!(way & kGoOn)) {
        status = kNothing;
        address = static_cast<uint8_t>(chip << 1 | (way & kRead));
        TWCR = static_cast<uint8_t>(kGo | (1 << TWSTA) | (TWCR & (1 << TWSTO)));
    } else if (way & kRead) {
        TWCR = readOn();
    } else {
        TWCR = kLast;
    }
    return true;
}

// Only finish() looks at the result, as the interrupt may end the part at any time; it marks the bus as free.
I2c::Result I2c::finishPart() {
    const Result now = finish();
    if (now == kKept) {
        result = kKept;
    } else if (now != kBusy) {
        part = 0;
    }
    return now;
}

I2c::Fault I2c::fault() {
    switch (status) {
        case kNothing:
            return kHeldLow;
        case 0x20:  // neither addressed to write
        case 0x48:  // nor to read
            return kNoAddress;
        case 0x30:  // a byte was written and not acknowledged
            return kNoData;
        default:
            return kTooSlow;
    }
}

// A chip whose byte was acknowledged sends its next one already: a 0 in it leaves no way to a STOP.
I2c::Fault I2c::endParts() {
    part = 0;
    if (result != kKept) return kNoFault;
    if (status == kReadMore) {
        freeBus();
        return kNoFault;
    }
    TWCR = asip::kStop;
    result = kFree;
    return kNoFault;
}

__attribute__((always_inline)) static inline uint8_t end(I2c::Result how) {
    result = how;
    return how == I2c::kKept ? kKeep : kStop;
}

// What the TWI has just done, by the status codes of the chip's data sheet, and what comes next.
static inline uint8_t goOn(uint8_t now) {
    if (part == 0 && readCount == 0) __builtin_unreachable();
    const bool isPart = part != 0 || readCount == 0;
    if (isPart) status = now;
    if (now == 0x08 || now == 0x10) {  // started, or started again: to read, if it is a whole transfer
        TWDR = isPart || now == 0x08 ? address : address | 1;
        return kGo;
    }
    if (!isPart && now == 0x18) {
        TWDR = firstByte;
        return kGo;
    }
    if (now == 0x18 || now == 0x28) {  // addressed to write, or a byte was written
        if (left != 0) return writeOn();
        if (!isPart && readCount != 1) return kGo | (1 << TWSTA);
    } else if (now == kReadMore || now == 0x58) {  // a byte was read, or the last one
        *next++ = TWDR;
        --left;
        if (now == kReadMore && (!isPart || left != 0)) return readOn();
    } else {
        if (now != 0x40) return end(I2c::kFailed);
        if (!isPart) {
            next = readTo;
            left = static_cast<uint8_t>(readCount - 1);
        }
        return readOn();  // addressed to read
    }
    return end(!isPart || (part & I2c::kStop) ? I2c::kDone : I2c::kKept);
}

}  // namespace asip

ISR(TWI_vect) {
    TWCR = asip::goOn(TWSR & 0xF8);
}

#elif defined(ARDUINO)
#include <Arduino.h>

#include "Board.h"

namespace asip {

static I2c::Begin beginWire;
static I2c::Transfer transferByWire;
static I2c::Part partByWire;
static I2c::Fault lastFault;
static uint8_t dataPin, clockPin;
static uint8_t result;
static const Service* owner;  // of the pins

bool I2c::use(Begin begin, Transfer transfer, Part part, uint8_t data, uint8_t clock) {
    beginWire = begin;
    transferByWire = transfer;
    partByWire = part;
    dataPin = data;
    clockPin = clock;
    return true;
}

// A chip that was interrupted while it sent holds SDA low until it got the clocks of its byte.
static void freeBus() {
    pinMode(dataPin, INPUT_PULLUP);
    pinMode(clockPin, INPUT_PULLUP);
    for (uint8_t clocks = 0; clocks < 9 && digitalRead(dataPin) == LOW; ++clocks) {
        pinMode(clockPin, OUTPUT);
        digitalWrite(clockPin, LOW);
        delayMicroseconds(5);
        pinMode(clockPin, INPUT_PULLUP);
        delayMicroseconds(5);
    }
    beginWire();
    result = I2c::kFree;
}

Error I2c::begin(const Service& service) {
    if (isEnabled()) return Error::kNone;
    if (beginWire == nullptr || !board.canClaim(dataPin, service) || !board.canClaim(clockPin, service))
        return Error::kI2cNotEnabled;
    board.claimPin(dataPin, service);
    board.claimPin(clockPin, service);
    owner = &service;
    hw::busPins[0] = dataPin;
    hw::busPins[1] = clockPin;
    freeBus();
    return Error::kNone;
}

bool I2c::isEnabled() {
    return owner != nullptr && board.ownsPin(dataPin, *owner);
}

bool I2c::start(uint8_t address, uint8_t first, const uint8_t* sent, uint8_t sentCount, uint8_t* in,
                uint8_t inCount) {
    if (result != kFree || !isEnabled()) return false;
    const bool done = transferByWire(address, first, sent, sentCount, in, inCount);
    if (!done && digitalRead(dataPin) == LOW) freeBus();
    result = done ? kDone : kFailed;
    return true;
}

I2c::Result I2c::finish() {
    const uint8_t now = result;
    result = kFree;
    return static_cast<Result>(now);
}

bool I2c::startPart(uint8_t way, uint8_t address, uint8_t* bytes, uint8_t count) {
    if ((result != kFree && result != kKept) || !isEnabled()) return false;
    lastFault = partByWire(way | kParts, address, bytes, count);
    if (lastFault != kNoFault && digitalRead(dataPin) == LOW) {
        lastFault = kHeldLow;
        freeBus();
    }
    result = lastFault != kNoFault ? kFailed : way & kStop ? kDone : kKept;
    return true;
}

I2c::Result I2c::finishPart() {
    return result == kKept ? kKept : finish();
}

I2c::Fault I2c::fault() {
    return lastFault;
}

I2c::Fault I2c::endParts() {
    const Fault fault = result == kKept ? partByWire(0, 0, nullptr, 0) : kNoFault;
    result = kFree;
    return fault;
}

}  // namespace asip

#endif
