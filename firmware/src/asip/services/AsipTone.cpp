// SPDX-License-Identifier: Apache-2.0
#include "AsipTone.h"

#ifdef ARDUINO

#include "asip/Hardware.h"
#include "asip/parts/ToneTimer.h"

namespace asip {

static constexpr uint16_t kLowestHertz = 31;  // what the timer can do

FlashText Tone::name() const {
    return ASIP_NAME("Tone");
}

void Tone::begin() {
    hw::takeTimer(ToneTimer::kTimer);
    ToneTimer::stop(pin_);
    board.claimPin(pin_, *this);
}

Error Tone::processRequest(Request& request) {
    if (request.tag() != 'P') return Error::kUnknownRequest;
    const uint16_t hertz = request.number();
    const uint16_t milliseconds = request.number();
    if (!request.complete() || (hertz != 0 && hertz < kLowestHertz)) return Error::kBadArgument;
    if (!board.ownsPin(pin_, *this)) return Error::kDeviceNotAvailable;
    if (hertz == 0 || milliseconds == 0) {
        ToneTimer::stop(pin_);
    } else {
        ToneTimer::start(pin_, hertz, milliseconds);
    }
    return Error::kNone;
}

}  // namespace asip

#endif
