// SPDX-License-Identifier: Apache-2.0
#include "DhtPulses.h"

#ifdef ARDUINO
#include <Arduino.h>

#include "asip/PinInterrupts.h"
#include "asip/QuickPin.h"

namespace asip {

// From the data sheets of DHT11 and AM2302: a bit is 50 us low and then high, for 26 to 28 us if it is 0 and
// for 70 if it is 1. From fall to fall these are 78 and 120 us, so an interrupt may come 20 us late. The
// first two falls begin and end the 160 us with which a sensor says that it is there.
static constexpr uint8_t kMicrosecondsOfOne = 100;
static constexpr uint8_t kFallsBefore = 2, kBits = 40;

#ifdef __AVR__
// The timer of millis() counts on each 64 cycles of the clock: to read it takes no call.
typedef uint8_t Time;
static constexpr Time kOne = static_cast<Time>(kMicrosecondsOfOne * clockCyclesPerMicrosecond() / 64);
static inline Time now() {
    return TCNT0;
}
#else
typedef uint16_t Time;
static constexpr Time kOne = kMicrosecondsOfOne;
static inline Time ASIP_FROM_INTERRUPT now() {
    return static_cast<Time>(micros());
}
#endif

static QuickPin line;
static volatile uint8_t falls = kBits + kFallsBefore;
static bool wasHigh;
static Time since;
static uint8_t received[kBits / 8];

void DhtPulses::start(uint8_t pin) {
    line = QuickPin(pin);
    wasHigh = false;
    falls = 0;
    PinInterrupts::enableDht(pin);
    pinMode(pin, INPUT_PULLUP);
}

bool DhtPulses::areComplete() {
    return falls == kBits + kFallsBefore;
}

bool DhtPulses::areNone() {
    return falls <= kFallsBefore;
}

const uint8_t* DhtPulses::bytes() {
    return received;
}

// Called for the pins of other services too.
void ASIP_FROM_INTERRUPT DhtPulses::onPinChange() {
    const bool high = line.isHigh();
    if (high == wasHigh) return;
    wasHigh = high;
    const uint8_t before = falls;
    if (high || before == kBits + kFallsBefore) return;
    const Time time = now();
    if (before >= kFallsBefore) {
        uint8_t& byte = received[static_cast<uint8_t>(before - kFallsBefore) / 8];
        byte = static_cast<uint8_t>(byte << 1);
        if (static_cast<Time>(time - since) > kOne) ++byte;
    }
    since = time;
    falls = static_cast<uint8_t>(before + 1);
}

}  // namespace asip

#endif
