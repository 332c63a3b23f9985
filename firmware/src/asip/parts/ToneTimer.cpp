// SPDX-License-Identifier: Apache-2.0
#include "ToneTimer.h"

#ifdef ARDUINO
#include <Arduino.h>

#if defined(TCCR2A) || !defined(__AVR__)

namespace asip {

void ToneTimer::start(uint8_t pin, uint16_t hertz, uint16_t milliseconds) {
    tone(pin, hertz, milliseconds);
}

void ToneTimer::stop(uint8_t pin) {
    noTone(pin);
}

}  // namespace asip

#else

namespace asip {

// The timer counts eighths of the clock and is never stopped: ServoPulses uses it in the same way.
static constexpr uint32_t kTicksPerSecond = F_CPU / 8;
static constexpr uint16_t kShortestHalf = F_CPU / 8 / 40000;  // 20 kHz: more would be nothing but interrupts

static volatile uint8_t* toggle;
static uint8_t mask;
static uint16_t half;           // ticks
static volatile uint32_t left;  // edges

void ToneTimer::start(uint8_t pin, uint16_t hertz, uint16_t milliseconds) {
    stop(pin);
    pinMode(pin, OUTPUT);
    toggle = portInputRegister(digitalPinToPort(pin));  // a 1 written there turns the output over
    mask = digitalPinToBitMask(pin);
    const uint16_t ticks = static_cast<uint16_t>(kTicksPerSecond / 2 / hertz);
    half = ticks < kShortestHalf ? kShortestHalf : ticks;
    left = static_cast<uint32_t>(hertz) * milliseconds / 500;
    if (left == 0) left = 1;
    noInterrupts();
    TCCR1A = 0;
    TCCR1B = _BV(CS11);
    OCR1B = TCNT1 + half;
    TIFR1 = _BV(OCF1B);
    TIMSK1 |= _BV(OCIE1B);
    interrupts();
}

void ToneTimer::stop(uint8_t pin) {
    TIMSK1 &= static_cast<uint8_t>(~_BV(OCIE1B));
    digitalWrite(pin, LOW);
}

}  // namespace asip

ISR(TIMER1_COMPB_vect) {
    using namespace asip;
    *toggle = mask;
    // An edge that comes late must not miss its next moment, which would come round only after 33 ms.
    const uint16_t next = OCR1B + half;
    const uint16_t soonest = TCNT1 + 8;
    OCR1B = static_cast<int16_t>(next - soonest) < 0 ? soonest : next;
    if (--left != 0) return;
    TIMSK1 &= static_cast<uint8_t>(~_BV(OCIE1B));
    if (*toggle & mask) *toggle = mask;  // ends low
}

#endif
#endif
