// SPDX-License-Identifier: Apache-2.0
// The system service `#`, as 0.4 boards have it.
#include "Board.h"

namespace asip {

Error Board::processSystem(Request& request) {
    const char tag = request.tag();
    if (tag == '?' || tag == 'N' || tag == 'S' || tag == 'R') {
        if (!request.complete()) return Error::kBadArgument;
        if (tag == '?') sendVersion();
        if (tag == 'N' || tag == 'S') startList(nullptr, '#', tag, tag == 'N' ? countServices() : hw::kPins);
        if (tag == 'R') restart();
        return Error::kNone;
    }
    return kExtensions ? processExtension(request) : Error::kUnknownRequest;
}

void Board::sendVersion() {
    out.answer('#', '?');
    out.text(F("0,4,"));
    out.text(hw::chipName());
    out.character(',');
    out.number(hw::kPins);
    out.character(',');
    out.text(sketch_);
    out.end();
}

uint8_t Board::countServices() const {
    uint8_t count = 0;
    for (const Service* service = &io_; service != nullptr; service = service->next_)
        ++count;
    return count;
}

void Board::writeSystemElement(uint8_t index) {
    if (listTag_ == 'N') {
        const Service* const service = serviceAt(index);
        out.character(service->id());
        out.character(':');
        return out.text(service->name());
    }
    out.character(io_.mode(index) == PinMode::kReserved ? '@' : serviceAt(io_.owner(index))->id());
}

}  // namespace asip
