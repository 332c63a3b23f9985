// SPDX-License-Identifier: Apache-2.0
// The hardware interface on any Arduino core, by its plain functions alone: pins in ports of eight, in their
// order; no EEPROM, so that a name given by #,I is not kept (the answer shows it); no service takes a timer.
// Slower than on AVR, where ports are read at once. Define before the library is compiled (build flags) what
// your core has otherwise:
//
//   ASIP_CHIP "name"        what #,? says; no comma in it
//   ASIP_PINS 40            if pins are not numbered from 0 to NUM_DIGITAL_PINS - 1
//   ASIP_ANALOG_BITS 12     if analogRead() gives more than 10 bits
#pragma once

#include <Arduino.h>

#include "Flash.h"

#ifndef ASIP_CHIP
#ifdef ARDUINO_BOARD
#define ASIP_CHIP ARDUINO_BOARD
#else
#define ASIP_CHIP "Arduino"
#endif
#endif
#ifndef ASIP_PINS
#define ASIP_PINS NUM_DIGITAL_PINS
#endif
#ifndef ASIP_ANALOG_BITS
#define ASIP_ANALOG_BITS 10
#endif

namespace asip {
namespace hw {

constexpr uint8_t kPins = ASIP_PINS;
static_assert(ASIP_PINS <= 255, "a pin is one byte");
constexpr uint8_t kAnalogChannels = NUM_ANALOG_INPUTS;
constexpr uint8_t kFirstAnalogPin = A0;
static_assert(A0 + NUM_ANALOG_INPUTS <= ASIP_PINS, "A0 and what follows are pins too");
constexpr bool kHasAnalogOnlyPins = false;
constexpr uint8_t kFirstPort = 0, kLastPort = (kPins - 1) / 8;

inline FlashText chipName() {
    return F(ASIP_CHIP);
}

inline uint8_t portOf(uint8_t pin) {
    return pin / 8;
}
inline uint8_t maskOf(uint8_t pin) {
    return static_cast<uint8_t>(1 << pin % 8);
}

inline uint8_t readPort(uint8_t port) {
    uint8_t levels = 0;
    for (uint8_t bit = 0; bit < 8 && port * 8 + bit < kPins; ++bit)
        if (::digitalRead(static_cast<uint8_t>(port * 8 + bit)) == HIGH)
            levels = static_cast<uint8_t>(levels | 1 << bit);
    return levels;
}

inline bool hasPwm(uint8_t pin) {
#ifdef digitalPinHasPWM
    return digitalPinHasPWM(pin);
#else
    (void)pin;
    return false;
#endif
}
inline bool isAnalog(uint8_t pin) {
    return pin >= kFirstAnalogPin && pin < kFirstAnalogPin + kAnalogChannels;
}
inline bool isAnalogOnly(uint8_t) {
    return false;
}
inline bool isAlias(uint8_t) {
    return false;
}

constexpr uint8_t kTimer1 = 2, kTimer2 = 4;
inline void takeTimer(uint8_t) {}
inline bool losesPwm(uint8_t) {
    return false;
}

inline bool isBusPin(uint16_t) {
    return false;
}

inline void setInput(uint8_t pin) {
    ::pinMode(pin, INPUT);
}
inline void setPullUp(uint8_t pin) {
    ::pinMode(pin, INPUT_PULLUP);
}
inline void setOutput(uint8_t pin) {
    ::pinMode(pin, OUTPUT);
}
inline void writePin(uint8_t pin, bool high) {
    ::digitalWrite(pin, high ? HIGH : LOW);
}
inline void writePwm(uint8_t pin, uint8_t duty) {
    ::analogWrite(pin, duty);
}
inline uint16_t readAnalog(uint8_t channel) {
    const int value = ::analogRead(static_cast<uint8_t>(kFirstAnalogPin + channel));
    return static_cast<uint16_t>(value >> (ASIP_ANALOG_BITS - 10));
}

inline uint8_t milliseconds() {
    return static_cast<uint8_t>(::millis());
}

constexpr uint16_t kEepromEnd = 63;
inline bool eepromReady() {
    return true;
}
inline uint8_t readEeprom(uint16_t) {
    return 0xFF;
}
inline void writeEeprom(uint16_t, uint8_t) {}

}  // namespace hw
}  // namespace asip
