#include "AsipEncoders.h"

#ifdef ARDUINO

namespace asip {

FlashText Encoders::name() const {
    return F("Encoders");
}

void Encoders::begin() {
    for (uint8_t i = 0; i < 2 * count(); ++i) {
        if (board.claimPin(pins_[i], *this) == Error::kNone) pinMode(pins_[i], INPUT_PULLUP);
    }
    for (uint8_t i = 0; i < count(); ++i)
        wheels_[i] = Wheel();
}

Error Encoders::processRequest(Request&) {
    return Error::kUnknownRequest;
}

void Encoders::reportValue(uint8_t index) {
    Wheel& wheel = wheels_[index];
    out.number(wheel.width);
    out.character(':');
    out.signedNumber(wheel.steps);
    wheel.width = 0;
    wheel.steps = 0;
}

void Encoders::poll() {
    for (uint8_t i = 0; i < count(); ++i) {
        Wheel& wheel = wheels_[i];
        const bool high = digitalRead(pins_[2 * i]);
        if (high && !wheel.wasHigh) {
            wheel.steps += digitalRead(pins_[2 * i + 1]) ? -1 : 1;
            const uint32_t now = micros();
            const uint32_t width = now - wheel.lastStep;
            wheel.width = width > 65535 ? 65535 : static_cast<uint16_t>(width);
            wheel.lastStep = now;
        }
        wheel.wasHigh = high;
    }
}

}  // namespace asip

#endif
