// SPDX-License-Identifier: Apache-2.0
#include "PinInterrupts.h"

#ifdef ARDUINO
#include <Arduino.h>

#include "Hardware.h"
#include "parts/DhtPulses.h"

namespace asip {

#if defined(__AVR_ATmega328P__) || defined(__AVR_ATmega328__) || defined(__AVR_ATmega168P__) || \
    defined(__AVR_ATmega168__)

// The ports B (2), C and D have a register each, one behind another, with the bits of the port. The core's
// macros compare the pin once more for each of these.
static volatile uint8_t& registerOf(uint8_t pin) {
    return (&PCMSK0)[static_cast<uint8_t>(hw::portOf(pin) - 2) & 3];
}
static bool enablePin(uint8_t pin, PinInterrupts::Handler) {
    registerOf(pin) |= hw::maskOf(pin);
    PCICR = (1 << PCIE0) | (1 << PCIE1) | (1 << PCIE2);
    return true;
}
static void disablePin(uint8_t pin) {
    registerOf(pin) &= static_cast<uint8_t>(~hw::maskOf(pin));
}

#else

// Called through the core, which takes 40 cycles more than a vector of one's own, only where it must be.
#if !defined(__AVR__) || defined(__AVR_ATmega2560__) || defined(__AVR_ATmega1280__) || \
    defined(__AVR_ATmega32U4__)
static bool enableExternal(uint8_t pin, PinInterrupts::Handler handler) {
    if (digitalPinToInterrupt(pin) == NOT_AN_INTERRUPT) return false;
    attachInterrupt(static_cast<uint8_t>(digitalPinToInterrupt(pin)), handler, CHANGE);
    return true;
}
static void disableExternal(uint8_t pin) {
    if (digitalPinToInterrupt(pin) != NOT_AN_INTERRUPT)
        detachInterrupt(static_cast<uint8_t>(digitalPinToInterrupt(pin)));
}
#else
static bool enableExternal(uint8_t, PinInterrupts::Handler) {
    return false;
}
static void disableExternal(uint8_t) {}
#endif

#ifdef __AVR__
static bool enablePin(uint8_t pin, PinInterrupts::Handler handler) {
    if (digitalPinToPCICR(pin) == nullptr) return enableExternal(pin, handler);
    *digitalPinToPCMSK(pin) |= _BV(digitalPinToPCMSKbit(pin));
    *digitalPinToPCICR(pin) |= _BV(digitalPinToPCICRbit(pin));
    return true;
}
static void disablePin(uint8_t pin) {
    if (digitalPinToPCICR(pin) == nullptr) return disableExternal(pin);
    *digitalPinToPCMSK(pin) &= static_cast<uint8_t>(~_BV(digitalPinToPCMSKbit(pin)));
}
#endif

#endif

#ifdef __AVR__

static PinInterrupts::Handler handlers[2];
static bool hasDht;  // never written where no such service is

bool PinInterrupts::enableDht(uint8_t pin) {
    hasDht = true;
    return enablePin(pin, DhtPulses::onPinChange);
}

bool PinInterrupts::enable(uint8_t pin, Slot slot, Handler handler) {
    handlers[slot] = handler;
    return enablePin(pin, handler);
}

void PinInterrupts::disable(uint8_t pin) {
    disablePin(pin);
}

}  // namespace asip

ISR(PCINT0_vect) {
    using namespace asip;
    if (hasDht) DhtPulses::onPinChange();
    for (uint8_t i = 0; i < 2; ++i)
        if (handlers[i] != nullptr) handlers[i]();
}
#if defined(PCINT1_vect)
ISR(PCINT1_vect, ISR_ALIASOF(PCINT0_vect));
#endif
#if defined(PCINT2_vect)
ISR(PCINT2_vect, ISR_ALIASOF(PCINT0_vect));
#endif
#if defined(PCINT3_vect)
ISR(PCINT3_vect, ISR_ALIASOF(PCINT0_vect));
#endif

#else

bool PinInterrupts::enable(uint8_t pin, Slot, Handler handler) {
    return enableExternal(pin, handler);
}

bool PinInterrupts::enableDht(uint8_t pin) {
    return enableExternal(pin, DhtPulses::onPinChange);
}

void PinInterrupts::disable(uint8_t pin) {
    disableExternal(pin);
}

}  // namespace asip

#endif
#endif
