// SPDX-License-Identifier: Apache-2.0
// The hardware interface on the Arduino core for AVR: pins and ports, time, EEPROM. Inline, and as thin as it
// can be.
#pragma once

#include <Arduino.h>
#include <avr/eeprom.h>

#include "Flash.h"

extern "C" volatile unsigned long timer0_millis;  // the Arduino core's clock

namespace asip {
namespace hw {

// The chips whose ports and timers are known here. kFirstPort and kLastPort are numbers of the Arduino core.
#if defined(__AVR_ATmega2560__) || defined(__AVR_ATmega1280__)
constexpr uint8_t kFirstPort = 1, kLastPort = 12;
#elif defined(__AVR_ATmega32U4__)
constexpr uint8_t kFirstPort = 2, kLastPort = 6;
#elif defined(__AVR_ATmega1284P__) || defined(__AVR_ATmega1284__) || defined(__AVR_ATmega644P__) || \
    defined(__AVR_ATmega644__)
constexpr uint8_t kFirstPort = 1, kLastPort = 4;
#elif defined(__AVR_ATmega328P__) || defined(__AVR_ATmega328__) || defined(__AVR_ATmega168P__) || \
    defined(__AVR_ATmega168__)
constexpr uint8_t kFirstPort = 2, kLastPort = 4;
#else
#error \
    "Asip does not know this chip: it knows the ATmega168, 328, 644, 1284, 1280, 2560 and 32U4 (HardwareAvr.h)"
#endif

inline FlashText chipName() {
#if defined(__AVR_ATmega328P__)
    return F("ATmega328P");
#elif defined(__AVR_ATmega2560__)
    return F("ATmega2560");
#elif defined(__AVR_ATmega32U4__)
    return F("ATmega32U4");
#elif defined(__AVR_ATmega328__)
    return F("ATmega328");
#elif defined(__AVR_ATmega168P__)
    return F("ATmega168P");
#elif defined(__AVR_ATmega168__)
    return F("ATmega168");
#elif defined(__AVR_ATmega1280__)
    return F("ATmega1280");
#elif defined(__AVR_ATmega1284P__)
    return F("ATmega1284P");
#elif defined(__AVR_ATmega1284__)
    return F("ATmega1284");
#elif defined(__AVR_ATmega644P__)
    return F("ATmega644P");
#else
    return F("ATmega644");
#endif
}

constexpr uint8_t kAnalogChannels = NUM_ANALOG_INPUTS;
constexpr uint8_t kFirstAnalogPin = A0;
constexpr uint8_t kEndOfAnalogPins = kFirstAnalogPin + kAnalogChannels;

// A6 and A7 of a Nano or Pro Mini, which the core does not count: they have a converter and no port.
constexpr bool kHasAnalogOnlyPins = kEndOfAnalogPins > NUM_DIGITAL_PINS;
constexpr uint8_t kPins = kHasAnalogOnlyPins ? kEndOfAnalogPins : NUM_DIGITAL_PINS;
inline bool isAnalogOnly(uint8_t pin) {
    return kHasAnalogOnlyPins && pin >= NUM_DIGITAL_PINS;
}

inline uint8_t portOf(uint8_t pin) {
    return isAnalogOnly(pin) ? 0 : digitalPinToPort(pin);
}
inline uint8_t maskOf(uint8_t pin) {
    return isAnalogOnly(pin) ? 0 : digitalPinToBitMask(pin);
}

// The input registers lie three apart, up to G and again from H (8; there is no I). Looking them up in the
// core's table takes three times as long, and this is what each pass of the loop does most.
inline uint8_t readPort(uint8_t port) {
#if defined(__AVR_ATmega2560__) || defined(__AVR_ATmega1280__)
    if (port >= 8)
        return *reinterpret_cast<volatile uint8_t*>(0x100 - 3 * 8 + 3 * (port == 8 ? 8 : port - 1));
#endif
    return *reinterpret_cast<volatile uint8_t*>(0x20 - 3 + 3 * port);
}

// Timers that a service uses for something else than PWM. Costs nothing where no service takes one: what is
// never written is compiled as the constant that it is.
constexpr uint8_t kTimer1 = 2, kTimer2 = 4;
extern uint8_t takenTimers;

// From now on no pin of the timer has PWM.
inline void takeTimer(uint8_t timer) {
    takenTimers |= timer;
}

inline bool isTaken(uint8_t output) {
    return ((takenTimers & kTimer1) && output >= TIMER1A && output <= TIMER1C) ||
           ((takenTimers & kTimer2) && output >= TIMER2 && output <= TIMER2B);
}

inline bool hasPwm(uint8_t pin) {
    if (isAnalogOnly(pin)) return false;
    const uint8_t output = digitalPinToTimer(pin);
    return output != NOT_ON_TIMER && !isTaken(output);
}

// True if analogWrite() would disturb a service that has taken the pin's timer.
inline bool losesPwm(uint8_t pin) {
    return !isAnalogOnly(pin) && isTaken(digitalPinToTimer(pin));
}

// Set once a service has taken the pins of the I2C bus; costs nothing where none does.
extern bool busPinsTaken;
inline bool isBusPin(uint16_t pin) {
    return busPinsTaken && (pin == SDA || pin == SCL);
}

inline bool isAnalog(uint8_t pin) {
    return pin >= kFirstAnalogPin && pin < kEndOfAnalogPins;
}

// Every pin is there to be used.
inline bool isHidden(uint8_t) {
    return false;
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
    if (!isAnalogOnly(pin)) ::digitalWrite(pin, high);
}
inline void writePwm(uint8_t pin, uint8_t duty) {
    ::analogWrite(pin, duty);
}

// Takes 110 microseconds, in which interrupts go on.
inline uint16_t readAnalogPin(uint8_t pin) {
    return static_cast<uint16_t>(::analogRead(pin));
}
inline uint16_t readAnalog(uint8_t channel) {
    return readAnalogPin(static_cast<uint8_t>(kFirstAnalogPin + channel));
}

// By how much millis() goes on at once, at most: the core counts 16384 cycles, and makes up for what is left
// over by a millisecond more now and then.
constexpr uint8_t kLongestTick = 16384000UL / F_CPU + 1;

// The lowest byte of millis(), which takes no interrupt lock to read.
inline uint8_t milliseconds() {
    return *reinterpret_cast<volatile uint8_t*>(&timer0_millis);
}

// The same up to 65535, for services that wait for longer.
__attribute__((noinline)) inline uint16_t shortMilliseconds() {
    const uint8_t status = SREG;
    cli();
    const uint8_t low = milliseconds();
    const uint8_t high = reinterpret_cast<volatile uint8_t*>(&timer0_millis)[1];
    SREG = status;
    return static_cast<uint16_t>(high << 8 | low);
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
