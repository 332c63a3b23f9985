// SPDX-License-Identifier: Apache-2.0
// What the library needs of an Arduino core that is not AVR's, checked when it is compiled: one sentence for
// each function that is missing. <AsipSerial.h> checks the functions of the serial port.
#pragma once

#include <Arduino.h>

#ifndef F
#error "Asip needs F(text), a text in flash: this Arduino core has none"
#endif
#ifndef PROGMEM
#error \
    "Asip needs PROGMEM, for tables in flash (on chips without it an empty macro): this Arduino core has none"
#endif
#if !defined(pgm_read_byte) || !defined(pgm_read_word)
#error \
    "Asip needs pgm_read_byte() and pgm_read_word(), which read what is in flash: this Arduino core lacks one"
#endif
#if !defined(NUM_DIGITAL_PINS) && !defined(ASIP_PINS)
#error "Asip needs NUM_DIGITAL_PINS, the number of pins: define ASIP_PINS (HardwareChips.h)"
#endif
#if !defined(NUM_ANALOG_INPUTS) && !defined(ASIP_ANALOG_PINS)
#error "Asip needs NUM_ANALOG_INPUTS, the number of converters: define ASIP_ANALOG_PINS (HardwareChips.h)"
#endif
#ifndef digitalPinToInterrupt
#error "Asip needs digitalPinToInterrupt(pin), for distances and encoders: this Arduino core has none"
#endif

// Chosen where the core has no function of the name: anything fits the dots less well than what it has.
namespace asipMissing {
struct Missing {};
Missing pinMode(...);
Missing digitalWrite(...);
Missing digitalRead(...);
Missing analogRead(...);
Missing analogWrite(...);
Missing delayMicroseconds(...);
Missing tone(...);
Missing noTone(...);
Missing attachInterrupt(...);
Missing detachInterrupt(...);
template <int = 0>
Missing millis();
template <int = 0>
Missing micros();
#ifndef interrupts
template <int = 0>
Missing interrupts();
#endif
#ifndef noInterrupts
template <int = 0>
Missing noInterrupts();
#endif
}  // namespace asipMissing

namespace asip {
namespace coreCheck {

using namespace ::asipMissing;

template <typename Result>
struct IsThere {
    static constexpr bool value = true;
};
template <>
struct IsThere<Missing> {
    static constexpr bool value = false;
};

typedef void (*Handler)();
constexpr unsigned char kPin = 0;

#define ASIP_CORE_HAS(call) (asip::coreCheck::IsThere<decltype(call)>::value)
static_assert(ASIP_CORE_HAS(pinMode(kPin, INPUT_PULLUP)),
              "Asip needs pinMode(pin, INPUT, INPUT_PULLUP or OUTPUT): this Arduino core has none");
static_assert(ASIP_CORE_HAS(digitalWrite(kPin, HIGH)),
              "Asip needs digitalWrite(pin, level): this Arduino core has none");
static_assert(ASIP_CORE_HAS(digitalRead(kPin)), "Asip needs digitalRead(pin): this Arduino core has none");
static_assert(ASIP_CORE_HAS(analogRead(kPin)), "Asip needs analogRead(pin): this Arduino core has none");
static_assert(ASIP_CORE_HAS(analogWrite(kPin, 1)),
              "Asip needs analogWrite(pin, 0 to 255), for PWM: this Arduino core has none");
static_assert(ASIP_CORE_HAS(millis()), "Asip needs millis(), for periods: this Arduino core has none");
static_assert(ASIP_CORE_HAS(micros()),
              "Asip needs micros(), for echoes and encoders: this Arduino core has none");
static_assert(ASIP_CORE_HAS(delayMicroseconds(10)),
              "Asip needs delayMicroseconds(microseconds), for distances: this Arduino core has none");
static_assert(ASIP_CORE_HAS(tone(kPin, 440u, 100ul)),
              "Asip needs tone(pin, hertz, milliseconds): this Arduino core has none");
static_assert(ASIP_CORE_HAS(noTone(kPin)), "Asip needs noTone(pin): this Arduino core has none");
static_assert(ASIP_CORE_HAS(attachInterrupt(kPin, Handler(), CHANGE)),
              "Asip needs attachInterrupt(interrupt, handler, CHANGE): this Arduino core has none");
static_assert(ASIP_CORE_HAS(detachInterrupt(kPin)),
              "Asip needs detachInterrupt(interrupt): this Arduino core has none");
#ifndef interrupts
static_assert(ASIP_CORE_HAS(interrupts()), "Asip needs interrupts(): this Arduino core has none");
#endif
#ifndef noInterrupts
static_assert(ASIP_CORE_HAS(noInterrupts()), "Asip needs noInterrupts(): this Arduino core has none");
#endif
#undef ASIP_CORE_HAS

}  // namespace coreCheck
}  // namespace asip
