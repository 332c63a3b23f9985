// SPDX-License-Identifier: Apache-2.0
// The hardware interface on any Arduino core, by its plain functions alone (CoreCheck.h lists them): pins in
// ports of eight, in their order; no service takes a timer. Slower than on AVR, where ports are read at once.
// What differs from chip to chip is in HardwareChips.h.
#pragma once

#include <Arduino.h>

#include "CoreCheck.h"
#include "Flash.h"
#include "HardwareChips.h"

namespace asip {
namespace hw {

constexpr uint8_t kAnalogChannels = ASIP_ANALOG_PINS;
constexpr uint8_t kFirstAnalogPin = ASIP_FIRST_ANALOG_PIN;
static_assert(ASIP_PINS <= 254 && ASIP_FIRST_ANALOG_PIN + ASIP_ANALOG_PINS <= 254,
              "a pin is one byte, and 255 is none");

// A pin with a converter that is not counted with the others has no port: A0 of an ESP8266.
constexpr bool kHasAnalogOnlyPins = kFirstAnalogPin + kAnalogChannels > ASIP_PINS;
constexpr uint8_t kPins = kHasAnalogOnlyPins ? kFirstAnalogPin + kAnalogChannels : ASIP_PINS;
constexpr uint8_t kPortPins = ASIP_PINS;  // those that have a port
constexpr uint8_t kFirstPort = 0, kLastPort = (kPortPins - 1) / 8;

inline bool isAnalogOnly(uint8_t pin) {
    return kHasAnalogOnlyPins && pin >= kPortPins;
}

inline FlashText chipName() {
    return F(ASIP_CHIP);
}

// Pins that the board must leave alone: the program is read through them, or they do not exist.
inline bool isHidden(uint8_t pin) {
    return ASIP_IS_HIDDEN_PIN(pin);
}

inline uint8_t portOf(uint8_t pin) {
    return isAnalogOnly(pin) ? 0 : pin / 8;
}
inline uint8_t maskOf(uint8_t pin) {
    return isAnalogOnly(pin) ? 0 : static_cast<uint8_t>(1 << pin % 8);
}

inline uint8_t readPort(uint8_t port) {
    uint8_t levels = 0;
    for (uint8_t bit = 0; bit < 8 && port * 8 + bit < kPortPins; ++bit) {
        const uint8_t pin = static_cast<uint8_t>(port * 8 + bit);
        if (!isHidden(pin) && ::digitalRead(pin) == HIGH) levels = static_cast<uint8_t>(levels | 1 << bit);
    }
    return levels;
}

inline bool hasPwm(uint8_t pin) {
    return !isAnalogOnly(pin) && ASIP_HAS_PWM(pin);
}
inline bool isAnalog(uint8_t pin) {
    return pin >= kFirstAnalogPin && pin - kFirstAnalogPin < kAnalogChannels;
}
inline bool isAlias(uint8_t) {
    return false;
}

constexpr uint8_t kTimer1 = 2, kTimer2 = 4;
inline void takeTimer(uint8_t) {}
inline bool losesPwm(uint8_t) {
    return false;
}

// The pins of the I2C bus, once a service has taken them.
constexpr uint8_t kNoPin = 255;
extern uint8_t busPins[2];
inline bool isBusPin(uint16_t pin) {
    return pin == busPins[0] || pin == busPins[1];
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
    if (!isAnalogOnly(pin)) ::digitalWrite(pin, high ? HIGH : LOW);
}
inline void writePwm(uint8_t pin, uint8_t duty) {
    ::analogWrite(pin, duty);
}

// 0 to 1023, as the models have it, whatever the converter gives.
inline uint16_t readAnalogPin(uint8_t pin) {
    return static_cast<uint16_t>(::analogRead(pin) >> (ASIP_ANALOG_BITS - 10));
}
inline uint16_t readAnalog(uint8_t channel) {
    return readAnalogPin(static_cast<uint8_t>(kFirstAnalogPin + channel));
}

constexpr uint8_t kLongestTick = 1;
inline uint8_t milliseconds() {
    return static_cast<uint8_t>(::millis());
}
inline uint16_t shortMilliseconds() {
    return static_cast<uint16_t>(::millis());
}

#if ASIP_HAS_EEPROM
// A core that keeps EEPROM in its flash: it is read once, and written back with the last byte of a name.
// That stops the chip for some 50 milliseconds; a peer waits for the answer to #,I.
constexpr uint16_t kEepromEnd = ASIP_EEPROM_SIZE - 1;
inline void openEeprom() {
    static bool isOpen;
    if (!isOpen) EEPROM.begin(ASIP_EEPROM_SIZE);
    isOpen = true;
}
inline uint8_t readEeprom(uint16_t address) {
    openEeprom();
    return EEPROM.read(address);
}
inline void writeEeprom(uint16_t address, uint8_t value) {
    openEeprom();
    EEPROM.write(address, value);
    if (address == kEepromEnd - 1) EEPROM.commit();  // the length of the name, which comes last
}
#else
constexpr uint16_t kEepromEnd = 63;
inline uint8_t readEeprom(uint16_t) {
    return 0xFF;
}
inline void writeEeprom(uint16_t, uint8_t) {}
#endif
inline bool eepromReady() {
    return true;
}

}  // namespace hw
}  // namespace asip
