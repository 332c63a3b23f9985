// SPDX-License-Identifier: Apache-2.0
#define ASIP_LIBRARY_SOURCE
#ifdef ARDUINO

#include "AsipMotion.h"

#include <math.h>

namespace asip {

// From the register map of the MPU-6050 and the data sheet of the HMC5883L.
static constexpr uint8_t kMpu6050 = 0x68, kPower = 0x6B, kAwake = 0;
static constexpr uint8_t kFirstAcceleration = 0x3B, kFirstRate = 0x43;
static constexpr uint8_t kHmc5883l = 0x1E, kMode = 2, kContinuous = 0, kFirstField = 3;

FlashText Motion::name() const {
    switch (id()) {
        case kAccelerometer:
            return ASIP_NAME("Accelerometer");
        case kGyroscope:
            return ASIP_NAME("Gyro");
        default:
            return ASIP_NAME("Heading");
    }
}

I2cSensor::Outcome Motion::doStep(uint8_t step) {
    const bool compass = id() == kHeading;
    const uint8_t address = compass ? kHmc5883l : kMpu6050;
    if (step == 0) {
        bytes_[0] = compass ? kContinuous : kAwake;
        return transfer(address, compass ? kMode : kPower, bytes_, 1, nullptr, 0);
    }
    const uint8_t first = compass ? kFirstField : id() == kGyroscope ? kFirstRate : kFirstAcceleration;
    const Outcome outcome = transfer(address, first, nullptr, 0, bytes_, sizeof bytes_);
    return outcome == kNextStep ? kMeasured : outcome;
}

// The compass sends x, z, y.
int16_t Motion::axis(uint8_t index) const {
    if (id() == kHeading && index != 0) index = static_cast<uint8_t>(3 - index);
    return static_cast<int16_t>(bytes_[2 * index] << 8 | bytes_[2 * index + 1]);
}

void Motion::reportValue(uint8_t index) {
    if (index < 3) return out.signedNumber(axis(index));
    float degrees = static_cast<float>(atan2(axis(1), axis(0)) * (180 / M_PI));
    if (degrees < 0) degrees += 360;
    out.number(static_cast<uint16_t>(degrees) % 360);
}

}  // namespace asip

#endif
