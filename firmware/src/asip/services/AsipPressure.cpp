// SPDX-License-Identifier: Apache-2.0
#define ASIP_LIBRARY_SOURCE
#ifdef ARDUINO

#include "AsipPressure.h"

#include <math.h>

namespace asip {

// From the data sheet of the BMP085: registers, times and the conversion, whose names are kept.
static constexpr uint8_t kAddress = 0x77;
static constexpr uint8_t kCalibration = 0xAA, kControl = 0xF4, kResult = 0xF6;
static constexpr uint8_t kOversampling = 3;
static constexpr uint8_t kMeasureTemperature = 0x2E, kMeasurePressure = 0x34 + (kOversampling << 6);
static constexpr uint8_t kTemperatureMs = 5, kPressureMs = 26;

FlashText Pressure::name() const {
    return ASIP_NAME("Pressure");
}

I2cSensor::Outcome Pressure::doStep(uint8_t step) {
    Outcome outcome;
    switch (step) {
        case 0:
            return transfer(kAddress, kCalibration, nullptr, 0, calibration_, sizeof calibration_);
        case 1:
            raw_[0] = kMeasureTemperature;
            return transfer(kAddress, kControl, raw_, 1, nullptr, 0);
        case 2:
            return wait(kTemperatureMs);
        case 3:
            outcome = transfer(kAddress, kResult, nullptr, 0, raw_, 2);
            if (outcome == kNextStep) convertTemperature();
            return outcome;
        case 4:
            raw_[0] = kMeasurePressure;
            return transfer(kAddress, kControl, raw_, 1, nullptr, 0);
        case 5:
            return wait(kPressureMs);
        default:
            outcome = transfer(kAddress, kResult, nullptr, 0, raw_, 3);
            if (outcome != kNextStep) return outcome;
            convertPressure();
            return kMeasured;
    }
}

void Pressure::convertTemperature() {
    const uint16_t ut = static_cast<uint16_t>(raw_[0] << 8 | raw_[1]);
    const uint16_t ac5 = static_cast<uint16_t>(word(4)), ac6 = static_cast<uint16_t>(word(5));
    const int32_t x1 = (static_cast<int32_t>(ut) - ac6) * ac5 >> 15;
    const int32_t mc = word(9), divisor = x1 + word(10);
    b5_ = divisor == 0 ? 0 : x1 + mc * 2048 / divisor;
}

void Pressure::convertPressure() {
    const int32_t up = static_cast<int32_t>(static_cast<uint32_t>(raw_[0]) << 16 |
                                            static_cast<uint16_t>(raw_[1] << 8) | raw_[2]) >>
                       (8 - kOversampling);
    const int32_t b6 = b5_ - 4000;
    const int32_t square = b6 * b6 >> 12;
    int32_t x3 = (word(7) * square >> 11) + (word(1) * b6 >> 11);
    const int32_t b3 = (((static_cast<int32_t>(word(0)) * 4 + x3) << kOversampling) + 2) / 4;
    x3 = ((word(2) * b6 >> 13) + (word(6) * square >> 16) + 2) >> 2;
    const uint32_t b4 =
        static_cast<uint32_t>(static_cast<uint16_t>(word(3))) * static_cast<uint32_t>(x3 + 32768) >> 15;
    const uint32_t b7 = static_cast<uint32_t>(up - b3) * (50000UL >> kOversampling);
    if (b4 == 0) {
        pascals_ = 0;
        return;
    }
    const int32_t p = static_cast<int32_t>(b7 < 0x80000000UL ? b7 * 2 / b4 : b7 / b4 * 2);
    const int32_t x1 = (p >> 8) * (p >> 8) * 3038 >> 16;
    pascals_ = p + ((x1 + (-7357 * p >> 16) + 3791) >> 4);
}

// The international standard atmosphere: 44330 m * (1 - (p / p0) ^ (1 / 5.255)).
void Pressure::reportValue(uint8_t index) {
    if (index == 0) return out.hundredths(pascals_);
    if (index == 1) return out.hundredths(((b5_ + 8) >> 4) * 10);
    const float ratio = static_cast<float>(pascals_) / 101325;
    out.hundredths(static_cast<int32_t>(4433000 * (1 - pow(ratio, 0.190295))));
}

}  // namespace asip

#endif
