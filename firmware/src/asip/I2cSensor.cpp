// SPDX-License-Identifier: Apache-2.0
#define ASIP_LIBRARY_SOURCE
#include "I2cSensor.h"

#ifdef ARDUINO

namespace asip {

void I2cSensor::begin() {
    const bool enabled = I2c::begin(*this) == Error::kNone;
    setCount(enabled ? values_ : 0);
    isReady_ = isAsked_ = isWaiting_ = false;
    step_ = 0;
    state_ = enabled ? kSettingUp : kIdle;
}

// A is the core's while the chip is there.
Error I2cSensor::processRequest(Request& request) {
    if (request.tag() == 'A') {
        request.number();
    } else if (request.tag() != 'M') {
        return Error::kUnknownRequest;
    }
    if (!request.complete()) return Error::kBadArgument;
    if (!I2c::isEnabled()) return Error::kI2cNotEnabled;
    const bool known = count() != 0;
    start(known);
    return known ? Error::kNone : Error::kDeviceNotAvailable;
}

void I2cSensor::reportValues() {
    start(false);
}

// What is under way is the answer to this too.
void I2cSensor::start(bool asked) {
    if (asked) isAsked_ = true;
    if (state_ != kIdle || !I2c::isEnabled()) return;
    step_ = isReady_ ? setUpSteps_ : 0;
    state_ = isReady_ ? kMeasuring : kSettingUp;
}

void I2cSensor::poll() {
    if (state_ == kIdle) return;
    if (state_ == kReporting || state_ == kFailing) {
        if (!out.hasRoom()) return;
        if (state_ == kReporting) {
            board.sendList(*this, 'e', values_);
        } else {
            out.error(id(), 'e', Error::kDeviceNotAvailable);
        }
        state_ = kIdle;
        return;
    }
    // The values of a report that is under way stay as they are.
    if (out.isHeld() && !isWaiting_) return;
    const Outcome outcome = doStep(step_);
    if (outcome == kGoOn) return;
    if (outcome == kNotThere) return failed();
    ++step_;
    if (outcome == kMeasured) {
        isAsked_ = false;
        state_ = kReporting;
    } else if (state_ == kSettingUp && step_ == setUpSteps_) {
        isReady_ = true;
        setCount(values_);
        state_ = isAsked_ || period() != 0 ? kMeasuring : kIdle;
    }
}

void I2cSensor::failed() {
    setCount(0);
    isReady_ = false;
    state_ = isAsked_ ? kFailing : kIdle;
    isAsked_ = false;
}

I2cSensor::Outcome I2cSensor::transfer(uint8_t address, uint8_t first, const uint8_t* bytes, uint8_t outCount,
                                       uint8_t* in, uint8_t inCount) {
    if (!isWaiting_) {
        isWaiting_ = I2c::start(address, first, bytes, outCount, in, inCount);
        return kGoOn;
    }
    const I2c::Result result = I2c::finish();
    if (result == I2c::kBusy) return kGoOn;
    isWaiting_ = false;
    return result == I2c::kDone ? kNextStep : kNotThere;
}

I2cSensor::Outcome I2cSensor::wait(uint8_t milliseconds) {
    const uint8_t now = hw::milliseconds();
    if (!isWaiting_) {
        isWaiting_ = true;
        sinceMs_ = now;
    }
    if (static_cast<uint8_t>(now - sinceMs_) <= milliseconds + hw::kLongestTick) return kGoOn;
    isWaiting_ = false;
    return kNextStep;
}

}  // namespace asip

#endif
