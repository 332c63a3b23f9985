// SPDX-License-Identifier: Apache-2.0
#include "AsipBump.h"

#ifdef ARDUINO

namespace asip {

FlashText Bump::name() const {
    return ASIP_NAME("Bump Sensors");
}

void Bump::begin() {
    for (uint8_t i = 0; i < count(); ++i) {
        if (board.claimPin(pins_[i], *this) == Error::kNone) pinMode(pins_[i], INPUT_PULLUP);
    }
}

Error Bump::processRequest(Request&) {
    return Error::kUnknownRequest;
}

void Bump::reportValue(uint8_t index) {
    // One whose pin is in use elsewhere is free.
    const bool free = !board.ownsPin(pins_[index], *this) || digitalRead(pins_[index]) == HIGH;
    out.number(free);
}

}  // namespace asip

#endif
