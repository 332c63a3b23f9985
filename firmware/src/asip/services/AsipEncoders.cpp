// SPDX-License-Identifier: Apache-2.0
#include "AsipEncoders.h"

#ifdef ARDUINO

#include "asip/Line.h"
#include "asip/PinInterrupts.h"

namespace asip {

#ifdef __AVR__
// The edges of two wheels, one behind the other, take 40 us; the line at 1,000,000 baud can wait 30.
bool line::isRate(uint16_t hundreds) {
    return hundreds <= 5000 && canMakeRate(hundreds);
}
#endif

static Encoders* counting;

FlashText Encoders::name() const {
    return ASIP_NAME("Encoders");
}

void Encoders::begin() {
    noInterrupts();
    counting = this;
    flags_ &= static_cast<uint8_t>(~kNeedsPolling);
    for (uint8_t i = 0; i < count(); ++i) {
        wheels_[i] = Wheel();
        connect(i);
    }
    interrupts();
}

// An encoder of which a pin is in use elsewhere has no steps.
void Encoders::connect(uint8_t encoder) {
    const uint8_t* const pins = &pins_[2 * encoder];
    for (uint8_t i = 0; i < 2; ++i) {
        if (board.claimPin(pins[i], *this) != Error::kNone) return;
        pinMode(pins[i], INPUT_PULLUP);
    }
    Wheel& wheel = wheels_[encoder];
    wheel.first = QuickPin(pins[0]);
    wheel.second = QuickPin(pins[1]);
    wheel.wasHigh = wheel.first.isHigh();
    if (!PinInterrupts::enable(pins[0], PinInterrupts::kEncoders, onPinChange)) flags_ |= kNeedsPolling;
}

Error Encoders::processRequest(Request&) {
    return Error::kUnknownRequest;
}

void ASIP_FROM_INTERRUPT Encoders::onPinChange() {
    Wheel* wheel = counting->wheels_;
    uint32_t now = 0;  // one for all: reading the clock takes most of the time of an edge
    for (uint8_t left = counting->count(); left != 0; --left, ++wheel) {
        if (!wheel->first.isConnected() || wheel->first.isHigh() == wheel->wasHigh) continue;
        if (now == 0) now = micros() | 1;
        countEdge(*wheel, now);
    }
}

void ASIP_FROM_INTERRUPT Encoders::countEdge(Wheel& wheel, uint32_t now) {
    const bool high = !wheel.wasHigh;
    wheel.wasHigh = high;
    if (high != wheel.second.isHigh()) {
        ++wheel.steps;
    } else {
        --wheel.steps;
    }
    if (wheel.changed != 0) wheel.pulse = now - wheel.changed;
    wheel.changed = now;
}

void Encoders::reportValue(uint8_t index) {
    Wheel& wheel = wheels_[index];
    noInterrupts();
    const int32_t steps = wheel.steps;
    const uint32_t pulse = wheel.pulse;
    wheel.steps = 0;
    interrupts();
    out.longNumber(pulse);
    out.character(':');
    out.signedLongNumber(isMirrored(index) ? -steps : steps);
}

void Encoders::poll() {
    if (!(flags_ & kNeedsPolling)) return;
    noInterrupts();
    onPinChange();
    interrupts();
}

}  // namespace asip

#endif
