// SPDX-License-Identifier: Apache-2.0
#include "AsipMotors.h"

#ifdef ARDUINO

#include "asip/Hardware.h"

namespace asip {

FlashText Motors::name() const {
    return ASIP_NAME("Motors");
}

void Motors::begin() {
    available_ = true;
    for (uint8_t i = 0; i < 3 * used_; ++i) {
        if (board.claimPin(pins_[i], *this) != Error::kNone) available_ = false;
    }
    if (!isAvailable()) return;
    for (uint8_t i = 0; i < 3 * used_; ++i)
        pinMode(pins_[i], OUTPUT);
    for (uint8_t motor = 0; motor < used_; ++motor)
        setPower(motor, 0);
}

// Looked at anew each time: the service that takes a timer may begin after this one.
bool Motors::isAvailable() const {
    for (uint8_t motor = 0; motor < used_; ++motor)
        if (hw::losesPwm(pins_[3 * motor + 2])) return false;
    return available_;
}

void Motors::setPower(uint8_t motor, int16_t power) {
    const uint8_t* const pins = &pins_[3 * motor];
    digitalWrite(pins[0], power > 0);
    digitalWrite(pins[1], power < 0);
    analogWrite(pins[2], power < 0 ? -power : power);
}

Error Motors::processRequest(Request& request) {
    const char tag = request.tag();
    if (tag == 'A' && reported_ != nullptr) {
        const uint16_t period = request.number();
        if (!request.complete()) return Error::kBadArgument;
        setPeriod(period == 1 ? kUsualPeriodMs : period);
        return Error::kNone;
    }
    uint16_t motor = 0;
    int16_t powers[2] = {0, 0};
    if (tag == 'm' || tag == 's') motor = request.number();
    if (tag == 'm' || tag == 'M') powers[0] = request.clampedSignedNumber(255);
    if (tag == 'M') powers[1] = request.clampedSignedNumber(255);
    if (tag != 'm' && tag != 's' && tag != 'M' && tag != 'S') return Error::kUnknownRequest;
    if (!request.complete()) return Error::kBadArgument;
    if (motor >= used_ || (tag == 'M' && used_ < 2)) return Error::kInvalidDeviceNumber;
    if (!isAvailable()) return Error::kDeviceNotAvailable;
    if (tag == 'm' || tag == 's') {
        setPower(static_cast<uint8_t>(motor), powers[0]);
        return Error::kNone;
    }
    for (uint8_t i = 0; i < used_; ++i) {
        if (tag == 'S' || i < 2) setPower(i, tag == 'S' ? 0 : powers[i]);
    }
    return Error::kNone;
}

void Motors::reportValue(uint8_t index) {
    reported_->reportValue(index);
}

void Motors::reportValues() {
    board.sendList(*this, 'e', reported_->count());
}

}  // namespace asip

#endif
