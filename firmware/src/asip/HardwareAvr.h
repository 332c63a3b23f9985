// The hardware interface on the Arduino core: pins and ports, time, EEPROM. Inline, and as thin as it can be.
#pragma once

#include <Arduino.h>
#include <avr/eeprom.h>

#include "Flash.h"

extern "C" volatile unsigned long timer0_millis;  // the Arduino core's clock

namespace asip {
namespace hw {

constexpr uint8_t kPins = NUM_DIGITAL_PINS;
constexpr uint8_t kAnalogChannels = NUM_ANALOG_INPUTS;
constexpr uint8_t kFirstAnalogPin = A0;

#if defined(__AVR_ATmega2560__)
constexpr uint8_t kFirstPort = 1, kLastPort = 12;
#elif defined(__AVR_ATmega32U4__)
constexpr uint8_t kFirstPort = 2, kLastPort = 6;
#else
constexpr uint8_t kFirstPort = 2, kLastPort = 4;
#endif

inline FlashText chipName() {
#if defined(__AVR_ATmega328P__)
    return F("ATmega328P");
#elif defined(__AVR_ATmega2560__)
    return F("ATmega2560");
#elif defined(__AVR_ATmega32U4__)
    return F("ATmega32U4");
#else
    return F("AVR");
#endif
}

inline uint8_t portOf(uint8_t pin) {
    return digitalPinToPort(pin);
}
inline uint8_t maskOf(uint8_t pin) {
    return digitalPinToBitMask(pin);
}

// The input registers lie three apart, up to G and again from H (8; there is no I). Looking them up in the
// core's table takes three times as long, and this is what each pass of the loop does most.
inline uint8_t readPort(uint8_t port) {
#if defined(__AVR_ATmega2560__)
    if (port >= 8)
        return *reinterpret_cast<volatile uint8_t*>(0x100 - 3 * 8 + 3 * (port == 8 ? 8 : port - 1));
#endif
    return *reinterpret_cast<volatile uint8_t*>(0x20 - 3 + 3 * port);
}

inline bool hasPwm(uint8_t pin) {
    return digitalPinToTimer(pin) != NOT_ON_TIMER;
}

inline bool isAnalog(uint8_t pin) {
    return pin >= kFirstAnalogPin && pin < kFirstAnalogPin + kAnalogChannels;
}

// A second name of a pin that has a number of its own (A6 to A11 of a Leonardo).
inline bool isAlias(uint8_t pin) {
#if defined(__AVR_ATmega32U4__)
    return pin >= A6;
#else
    (void)pin;
    return false;
#endif
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
    ::digitalWrite(pin, high);
}
inline void writePwm(uint8_t pin, uint8_t duty) {
    ::analogWrite(pin, duty);
}

// Takes 110 microseconds, in which interrupts go on.
inline uint16_t readAnalog(uint8_t channel) {
    return static_cast<uint16_t>(::analogRead(static_cast<uint8_t>(kFirstAnalogPin + channel)));
}

// The lowest byte of millis(), which takes no interrupt lock to read.
inline uint8_t milliseconds() {
    return *reinterpret_cast<volatile uint8_t*>(&timer0_millis);
}

constexpr uint16_t kEepromEnd = E2END;
inline bool eepromReady() {
    return eeprom_is_ready();
}
inline uint8_t readEeprom(uint16_t address) {
    return eeprom_read_byte(reinterpret_cast<uint8_t*>(address));
}

// Begins to write (3.4 ms); call when ready.
inline void writeEeprom(uint16_t address, uint8_t value) {
    eeprom_update_byte(reinterpret_cast<uint8_t*>(address), value);
}

}  // namespace hw
}  // namespace asip
