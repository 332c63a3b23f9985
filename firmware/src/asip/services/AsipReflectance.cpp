// SPDX-License-Identifier: Apache-2.0
#include "AsipReflectance.h"

#ifdef ARDUINO

#include "asip/Hardware.h"

namespace asip {

static constexpr uint16_t kWarmMicroseconds = 200;  // until the sensors show the light

FlashText Reflectance::name() const {
    return ASIP_NAME("IR Sensors");
}

void Reflectance::begin() {
    warming_ = false;
    // Without emitters there is nothing to report.
    const bool available = board.claimPin(emitter_, *this) == Error::kNone;
    setCount(available ? sensors_ : 0);
    if (available) pinMode(emitter_, OUTPUT);
    for (uint8_t i = 0; i < sensors_; ++i)
        board.claimPin(pins_[i], *this);
}

Error Reflectance::processRequest(Request& request) {
    return request.tag() == 'A' ? Error::kDeviceNotAvailable : Error::kUnknownRequest;
}

void Reflectance::reportValues() {
    digitalWrite(emitter_, HIGH);
    warming_ = true;
    since_ = static_cast<uint16_t>(micros());
}

void Reflectance::poll() {
    if (!warming_ || static_cast<uint16_t>(micros() - since_) < kWarmMicroseconds || !out.hasRoom()) return;
    warming_ = false;
    board.sendList(*this, 'e', count());
}

void Reflectance::reportValue(uint8_t index) {
    out.number(hw::readAnalogPin(pins_[index]));
    if (index == count() - 1 && !warming_) digitalWrite(emitter_, LOW);
}

}  // namespace asip

#endif
