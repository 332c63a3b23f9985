// SPDX-License-Identifier: Apache-2.0
#ifdef __AVR__

#include "AsipServos.h"

#include "asip/Hardware.h"

namespace asip {

// In half microseconds: 1088, and 3712 more over 180 degrees.
static uint16_t pulseWidth(uint8_t angle) {
    return static_cast<uint16_t>(1088 + angle * 20 + angle * 28 / 45);
}

FlashText Servos::name() const {
    return ASIP_NAME("Servos");
}

void Servos::begin() {
    ServoPulses::stop();
    hw::takeTimer(hw::kTimer1);
    available_ = true;
    for (uint8_t i = 0; i < used_; ++i) {
        if (board.claimPin(pins_[i], *this) != Error::kNone) available_ = false;
    }
    for (uint8_t i = 0; available_ && i < used_; ++i) {
        ServoPulses::add(pins_[i]);
        ServoPulses::setWidth(i, pulseWidth(90));
    }
}

Error Servos::processRequest(Request& request) {
    if (request.tag() == 'W') return write(request);
    if (request.tag() == 'M') return remap(request);
    return Error::kUnknownRequest;
}

Error Servos::write(Request& request) {
    const uint16_t servo = request.number();
    const uint16_t angle = request.clampedNumber(180);
    if (!request.complete()) return Error::kBadArgument;
    if (servo >= used_) return Error::kInvalidDeviceNumber;
    if (!available_) return Error::kDeviceNotAvailable;
    ServoPulses::setWidth(static_cast<uint8_t>(servo), pulseWidth(static_cast<uint8_t>(angle)));
    return Error::kNone;
}

// All or nothing: the servos stay as they are if one of the pins is in use.
Error Servos::remap(Request& request) {
    const uint8_t count = static_cast<uint8_t>(request.number(kMaxServos));
    uint8_t pins[kMaxServos];
    for (uint8_t i = 0; i < count; ++i)
        pins[i] = static_cast<uint8_t>(request.number(255));
    if (!request.complete()) return Error::kBadArgument;
    for (uint8_t i = 0; i < count; ++i) {
        if (!board.canClaim(pins[i], *this)) return Error::kInvalidPin;
        for (uint8_t j = 0; j < i; ++j) {
            if (pins[j] == pins[i]) return Error::kInvalidPin;
        }
    }
    ServoPulses::stop();
    board.releasePins(*this);
    used_ = count;
    for (uint8_t i = 0; i < count; ++i)
        pins_[i] = pins[i];
    begin();
    return Error::kNone;
}

}  // namespace asip

#endif
