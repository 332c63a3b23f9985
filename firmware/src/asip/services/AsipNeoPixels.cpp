// SPDX-License-Identifier: Apache-2.0
#ifdef __AVR__

#include "AsipNeoPixels.h"

namespace asip {

FlashText NeoPixels::name() const {
    return ASIP_NAME("NeoPixels");
}

void NeoPixels::begin() {
    for (uint8_t i = 0; i < count_; ++i)
        strips_[i]->begin(*this);
}

void NeoPixels::poll() {
    for (uint8_t i = 0; i < count_; ++i)
        strips_[i]->poll();
}

Error NeoPixels::processRequest(Request& request) {
    const char tag = request.tag();
    if (tag != 'C' && tag != 'B' && tag != 'S') return Error::kUnknownRequest;
    const uint16_t number = request.number();
    if (!request.good()) return Error::kBadArgument;
    if (number >= count_) return Error::kInvalidDeviceNumber;
    PixelStrip& strip = *strips_[number];
    if (!strip.isAvailable(*this)) return Error::kDeviceNotAvailable;
    if (tag == 'C') return setColor(request, strip);
    const uint8_t brightness = tag == 'B' ? static_cast<uint8_t>(request.clampedNumber(255)) : 0;
    if (!request.complete()) return Error::kBadArgument;
    if (tag == 'S') {
        strip.show();
    } else {
        strip.setBrightness(brightness);
    }
    return Error::kNone;
}

Error NeoPixels::setColor(Request& request, PixelStrip& strip) {
    const uint16_t pixel = request.number();
    uint8_t color[3];
    for (uint8_t& part : color)
        part = static_cast<uint8_t>(request.number(255));
    if (!request.complete()) return Error::kBadArgument;
    if (pixel >= strip.count()) return Error::kInvalidDeviceNumber;
    strip.set(static_cast<uint8_t>(pixel), color[0], color[1], color[2]);
    return Error::kNone;
}

}  // namespace asip

#endif
