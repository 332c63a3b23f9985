// SPDX-License-Identifier: Apache-2.0
#include "AsipDistance.h"

#include "asip/parts/EchoTimer.h"

namespace asip {

FlashText Distance::name() const {
    return ASIP_NAME("Distance");
}

void Distance::begin() {
    EchoTimer::stop();
    sensor_ = kIdle;
    for (uint8_t i = 0; i < count(); ++i)
        board.claimPin(pins_[i], *this);
}

Error Distance::processRequest(Request& request) {
    if (request.tag() != 'M') return Error::kUnknownRequest;
    if (!request.complete()) return Error::kBadArgument;
    reportValues();
    return Error::kNone;
}

void Distance::reportValues() {
    if (sensor_ == kIdle) turnTo(0);  // else what is being measured is the answer to this too
}

void Distance::reportValue(uint8_t index) {
    out.number(centimetres_[index]);
}

// A sensor whose pin is in use elsewhere is passed over.
void Distance::turnTo(uint8_t sensor) {
    while (sensor < count() && !board.ownsPin(pins_[sensor], *this))
        ++sensor;
    sensor_ = sensor;
    if (sensor < count()) EchoTimer::start(pins_[sensor]);
}

void Distance::poll() {
    if (sensor_ == kIdle) return;
    if (sensor_ < count()) {
        uint16_t echo;
        if (!EchoTimer::finished(echo)) return;
        centimetres_[sensor_] = (echo - echo / 187 + 29) / 58;  // 58.31 microseconds a centimetre, there and
                                                                // back
        return turnTo(sensor_ + 1);
    }
    if (!out.hasRoom()) return;
    sensor_ = kIdle;
    board.sendList(*this, 'e', count());
}

}  // namespace asip
