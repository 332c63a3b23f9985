// SPDX-License-Identifier: Apache-2.0
#include "PinInterrupts.h"

#ifdef ARDUINO
#include <Arduino.h>

namespace asip {

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

static PinInterrupts::Handler handlers[2];
static PinInterrupts::Handler firstHandler;

static bool enablePin(uint8_t pin, PinInterrupts::Handler handler) {
    if (digitalPinToPCICR(pin) == nullptr) return enableExternal(pin, handler);
    *digitalPinToPCMSK(pin) |= _BV(digitalPinToPCMSKbit(pin));
    *digitalPinToPCICR(pin) |= _BV(digitalPinToPCICRbit(pin));
    return true;
}

bool PinInterrupts::enableAlone(uint8_t pin, Handler handler) {
    firstHandler = handler;
    return enablePin(pin, handler);
}

bool PinInterrupts::enable(uint8_t pin, Slot slot, Handler handler) {
    handlers[slot] = handler;
    return enablePin(pin, handler);
}

void PinInterrupts::disable(uint8_t pin) {
    if (digitalPinToPCICR(pin) == nullptr) return disableExternal(pin);
    *digitalPinToPCMSK(pin) &= static_cast<uint8_t>(~_BV(digitalPinToPCMSKbit(pin)));
}

}  // namespace asip

ISR(PCINT0_vect) {
    using namespace asip;
    if (firstHandler != nullptr) firstHandler();
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

bool PinInterrupts::enableAlone(uint8_t pin, Handler handler) {
    return enableExternal(pin, handler);
}

void PinInterrupts::disable(uint8_t pin) {
    disableExternal(pin);
}

}  // namespace asip

#endif
#endif
