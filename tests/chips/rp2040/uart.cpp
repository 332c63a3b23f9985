// SPDX-License-Identifier: Apache-2.0
// Serial is the first UART (a PL011), on pins 0 and 1.
#include <Arduino.h>

#include "registers.h"

using namespace rp2040;

static constexpr uint32_t kData = kUart0, kFlags = kUart0 + 0x18, kDivisor = kUart0 + 0x24,
                          kFraction = kUart0 + 0x28;
static constexpr uint32_t kFormat = kUart0 + 0x2c, kControl = kUart0 + 0x30, kLevels = kUart0 + 0x34;
static constexpr uint32_t kMask = kUart0 + 0x38, kClear = kUart0 + 0x44;
static constexpr uint32_t kBusy = 1u << 3, kNothingReceived = 1u << 4, kFull = 1u << 5;
static constexpr uint32_t kReceived = 1u << 4, kSent = 1u << 5, kTimeout = 1u << 6;
static constexpr uint32_t kDamaged = 0xfu << 8;  // framing, parity, break, overrun: beside the byte

ChipSerial Serial;

void ChipSerial::begin(unsigned long baud) {
    at(kControl) = 0;
    // In 64ths of a sixteenth of a bit.
    const uint32_t divisor = (8 * kUartHertz / baud + 1) / 2;
    at(kDivisor) = divisor / 64;
    at(kFraction) = divisor % 64;
    at(kFormat) = 3u << 5 | 1u << 4;  // eight bits, with queues
    at(kLevels) = 1u << 3;            // an interrupt from eight bytes on, and below four to send
    at(kClear) = 0x7ff;
    at(kMask) = kReceived | kTimeout;
    at(kControl) = 1u << 9 | 1u << 8 | 1;
    at(control(0)) = kFunctionUart;
    at(control(1)) = kFunctionUart;
    at(pad(1)) = kInputEnable | kPullUp;
    enableInterrupt(kUart0Irq);
}

// What has just come is here before its interrupt, which waits for more.
int ChipSerial::read() {
    if (received_.count() == 0 && (at(kFlags) & kNothingReceived) == 0) {
        noInterrupts();
        serve();
        interrupts();
    }
    return received_.count() == 0 ? -1 : received_.take();
}

int ChipSerial::availableForWrite() {
    return waiting_.room();
}

size_t ChipSerial::write(uint8_t byte) {
    while (waiting_.room() == 0) {
    }
    noInterrupts();
    waiting_.put(byte);
    fillTransmitter();
    interrupts();
    return 1;
}

void ChipSerial::flush() {
    while (waiting_.count() != 0 || (at(kFlags) & kBusy) != 0) {
    }
}

// A byte that arrived damaged, or before which bytes were lost, reads as 0, and so does the last one of a
// full ring.
void ChipSerial::serve() {
    while ((at(kFlags) & kNothingReceived) == 0) {
        const uint32_t data = at(kData);
        if (received_.room() > 1)
            received_.put((data & kDamaged) != 0 ? 0 : static_cast<uint8_t>(data));
        else if (received_.room() == 1)
            received_.put(0);
    }
    at(kClear) = kReceived | kTimeout | kSent;
    fillTransmitter();
}

void ChipSerial::fillTransmitter() {
    while (waiting_.count() != 0 && (at(kFlags) & kFull) == 0)
        at(kData) = waiting_.take();
    at(kMask) = kReceived | kTimeout | (waiting_.count() != 0 ? kSent : 0);
}

void rp2040::onUart() {
    Serial.serve();
}
