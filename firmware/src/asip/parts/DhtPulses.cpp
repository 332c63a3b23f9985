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
static constexpr uint8_t kFallsBefore = 2;

static QuickPin line;
static volatile uint8_t falls;
static bool wasHigh;
static uint16_t since;  // microseconds
static uint8_t received[DhtPulses::kBits / 8];

bool DhtPulses::start(uint8_t pin) {
    line = QuickPin(pin);
    falls = 0;
    wasHigh = false;
    const bool hasInterrupt = PinInterrupts::enableAlone(pin, onPinChange);
    pinMode(pin, INPUT_PULLUP);
    return hasInterrupt;
}

uint8_t DhtPulses::bits() {
    const uint8_t count = falls;
    return count <= kFallsBefore ? 0 : static_cast<uint8_t>(count - kFallsBefore);
}

const uint8_t* DhtPulses::bytes() {
    return received;
}

void DhtPulses::stop(uint8_t pin) {
    PinInterrupts::disable(pin);
}

// Called for the pins of other services too.
void ASIP_FROM_INTERRUPT DhtPulses::onPinChange() {
    const bool high = line.isHigh();
    if (high == wasHigh) return;
    wasHigh = high;
    const uint8_t before = falls;
    if (high || before == kBits + kFallsBefore) return;
    const uint16_t now = static_cast<uint16_t>(micros());
    if (before >= kFallsBefore) {
        uint8_t& byte = received[static_cast<uint8_t>(before - kFallsBefore) / 8];
        byte = static_cast<uint8_t>(byte << 1 | (static_cast<uint16_t>(now - since) > kMicrosecondsOfOne));
    }
    since = now;
    falls = static_cast<uint8_t>(before + 1);
}

}  // namespace asip

#endif
