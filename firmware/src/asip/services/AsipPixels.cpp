// SPDX-License-Identifier: Apache-2.0
#ifdef __AVR__

#include "AsipPixels.h"

namespace asip {

FlashText PixelService::name() const {
    return ASIP_NAME("Pixels");
}

void PixelService::begin() {
    if (lineSize_ > kMaxRequestLength + 1) board.useLongLines(line_, lineSize_);
    strip_.begin(*this);
}

Error PixelService::processRequest(Request& request) {
    switch (request.tag()) {
        case 'P':
        case 'S':
            return setPixels(request);
        case 'B': {
            const uint16_t brightness = request.clampedNumber(255);
            if (!request.complete()) return Error::kBadArgument;
            strip_.setBrightness(static_cast<uint8_t>(brightness));
            strip_.show();
            return Error::kNone;
        }
        case 'I':
            if (!request.complete()) return Error::kBadArgument;
            out.event('P', 'I');
            out.character(',');
            out.number(strip_.count());
            out.end();
            return Error::kNone;
        default:
            return Error::kUnknownRequest;
    }
}

// Read twice: nothing of a request is done before all of it is known to be good.
Error PixelService::setPixels(Request& request) {
    if (!strip_.isAvailable(*this)) return Error::kDeviceNotAvailable;
    Request again = request;
    const bool row = request.tag() == 'S';
    const Error error = row ? readRow(request, kCheck) : readPairs(request, kCheck);
    if (error != Error::kNone) return error;
    row ? readRow(again, kApply) : readPairs(again, kApply);
    strip_.show();
    return Error::kNone;
}

// COUNT,{pixel:color,...}
Error PixelService::readPairs(Request& request, Pass pass) {
    uint16_t left = request.number();
    bool there = true;
    request.expect(',');
    for (char before = '{'; left > 0 && request.good(); --left, before = ',') {
        request.expect(before);
        const uint32_t pixel = request.item(65535);
        request.expect(':');
        const uint32_t color = request.item(0xFFFFFF);
        if (pixel >= strip_.count()) {
            there = false;
        } else if (pass == kApply) {
            setColor(static_cast<uint16_t>(pixel), color);
        }
    }
    request.expect('}');
    if (!request.complete()) return Error::kBadArgument;
    return there ? Error::kNone : Error::kInvalidDeviceNumber;
}

// COUNT,first,{color,...}
Error PixelService::readRow(Request& request, Pass pass) {
    uint16_t left = request.number();
    uint16_t pixel = request.number();
    const uint16_t count = strip_.count();
    const bool there = pixel < count && left <= count - pixel;
    request.expect(',');
    for (char before = '{'; left > 0 && request.good(); --left, before = ',') {
        request.expect(before);
        const uint32_t color = request.item(0xFFFFFF);
        if (pass == kApply) setColor(pixel++, color);
    }
    request.expect('}');
    if (!request.complete()) return Error::kBadArgument;
    return there ? Error::kNone : Error::kInvalidDeviceNumber;
}

void PixelService::setColor(uint16_t pixel, uint32_t color) {
    strip_.set(static_cast<uint8_t>(pixel), static_cast<uint8_t>(color >> 16),
               static_cast<uint8_t>(color >> 8), static_cast<uint8_t>(color));
}

}  // namespace asip

#endif
