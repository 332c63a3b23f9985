// SPDX-License-Identifier: Apache-2.0
#include "ServoPulses.h"

#ifdef __AVR__
#include <Arduino.h>

namespace asip {

// The timer counts eighths of the clock (half microseconds at 16 MHz) and is never stopped. Eight of the
// longest pulses fit into a frame of 20 ms.
static constexpr uint16_t kFrameTicks = F_CPU / 8 / 50;
static constexpr uint16_t kSoon = F_CPU / 8 / 20000;  // 50 microseconds

static uint16_t toTicks(uint16_t halfMicroseconds) {
    return static_cast<uint16_t>(static_cast<uint32_t>(halfMicroseconds) * (F_CPU / 1000000) / 16);
}

struct Pulse {
    volatile uint8_t* port;
    uint8_t mask;
    uint16_t ticks;  // 0: at rest
};
static Pulse pulses[ServoPulses::kMaxServos];
static uint8_t pulseCount, current;
static uint16_t frameStart;

void ServoPulses::stop() {
    TIMSK1 &= static_cast<uint8_t>(~_BV(OCIE1A));
    for (uint8_t i = 0; i < pulseCount; ++i)
        *pulses[i].port &= static_cast<uint8_t>(~pulses[i].mask);
    pulseCount = current = 0;
}

void ServoPulses::add(uint8_t pin) {
    pinMode(pin, OUTPUT);
    noInterrupts();
    pulses[pulseCount].port = portOutputRegister(digitalPinToPort(pin));
    pulses[pulseCount].mask = digitalPinToBitMask(pin);
    pulses[pulseCount].ticks = 0;
    if (current == pulseCount++) current = pulseCount;  // between two frames, it stays so
    if (pulseCount == 1) {
        TCCR1A = 0;
        TCCR1B = _BV(CS11);
        OCR1A = TCNT1 + kSoon;
        TIFR1 = _BV(OCF1A);
        TIMSK1 |= _BV(OCIE1A);
    }
    interrupts();
}

void ServoPulses::setWidth(uint8_t servo, uint16_t halfMicroseconds) {
    const uint16_t ticks = toTicks(halfMicroseconds);
    noInterrupts();
    pulses[servo].ticks = ticks;
    interrupts();
}

}  // namespace asip

// Each moment is counted from the one before, not from when the interrupt got to run.
ISR(TIMER1_COMPA_vect) {
    using namespace asip;
    uint8_t servo = current;
    if (servo == pulseCount) {
        frameStart = OCR1A;
        servo = 0;
    } else {
        *pulses[servo].port &= static_cast<uint8_t>(~pulses[servo].mask);
        ++servo;
    }
    while (servo < pulseCount && pulses[servo].ticks == 0)
        ++servo;
    current = servo;
    if (servo == pulseCount) {
        OCR1A = frameStart + kFrameTicks;
    } else {
        *pulses[servo].port |= pulses[servo].mask;
        OCR1A += pulses[servo].ticks;
    }
}

#endif
