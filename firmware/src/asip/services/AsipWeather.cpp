// SPDX-License-Identifier: Apache-2.0
#define ASIP_LIBRARY_SOURCE
#ifdef ARDUINO

#include "AsipWeather.h"

namespace asip {

// From the data sheets of BME280 and BMP280: registers, and the conversion in 32 bits.
static constexpr uint8_t kIdentity = 0xD0, kBme280 = 0x60, kBmp280 = 0x58;
static constexpr uint8_t kCalibration = 0x88, kHumidityCalibration = 0xE1;
static constexpr uint8_t kControlHumidity = 0xF2, kControl = 0xF4, kResult = 0xF7;
static constexpr uint8_t kOnce = 1, kMeasureOnce = 0x25;  // each quantity once, then asleep again
static constexpr uint8_t kMeasureMs = 10;
static constexpr int32_t kNothingMeasured = 0x80000;

FlashText Weather::name() const {
    return ASIP_NAME("Weather");
}

I2cSensor::Outcome Weather::doStep(uint8_t step) {
    Outcome outcome;
    switch (step) {
        case 0:
            outcome = transfer(address_, kIdentity, nullptr, 0, raw_, 1);
            hasHumidity_ = raw_[0] == kBme280;
            return outcome == kNextStep && !hasHumidity_ && raw_[0] != kBmp280 ? kNotThere : outcome;
        case 1:
            return transfer(address_, kCalibration, nullptr, 0, calibration_, kFirstBytes);
        case 2:
            return transfer(address_, kHumidityCalibration, nullptr, 0, calibration_ + kFirstBytes,
                            kHumidityBytes);
        case 3:
            raw_[0] = kOnce;
            return transfer(address_, kControlHumidity, raw_, 1, nullptr, 0);
        case 4:
            raw_[0] = kMeasureOnce;
            return transfer(address_, kControl, raw_, 1, nullptr, 0);
        case 5:
            return wait(kMeasureMs);
        default:
            outcome = transfer(address_, kResult, nullptr, 0, raw_, sizeof raw_);
            return outcome == kNextStep ? convert() : outcome;
    }
}

// A chip that lost its power meanwhile has measured nothing.
I2cSensor::Outcome Weather::convert() {
    int32_t raw[2];  // pressure, temperature
    for (uint8_t i = 0; i < 2; ++i) {
        const uint8_t* const bytes = raw_ + 3 * i;
        raw[i] = static_cast<int32_t>(bytes[0]) << 12 | static_cast<uint16_t>(bytes[1] << 4) | bytes[2] >> 4;
    }
    if (raw[1] == kNothingMeasured) return kNotThere;
    const int32_t fine = convertTemperature(raw[1]);
    convertPressure(raw[0], fine);
    if (hasHumidity_) convertHumidity(static_cast<uint16_t>(raw_[6] << 8 | raw_[7]), fine);
    return kMeasured;
}

// The temperature in a finer measure, on which the others depend.
int32_t Weather::convertTemperature(int32_t raw) {
    const int32_t t1 = static_cast<uint16_t>(word(0));
    const int32_t linear = ((raw >> 3) - t1 * 2) * word(1) >> 11;
    const int32_t offset = (raw >> 4) - t1;
    const int32_t fine = linear + ((offset * offset >> 12) * word(2) >> 14);
    temperature_ = static_cast<int16_t>((fine * 5 + 128) >> 8);
    return fine;
}

void Weather::convertPressure(int32_t raw, int32_t fine) {
    const int32_t t = (fine >> 1) - 64000;
    const int32_t square = (t >> 2) * (t >> 2);
    const int32_t offset = (((square >> 11) * word(8) + t * word(7) * 2) >> 2) + word(6) * 65536L;
    const int32_t slope = ((word(5) * (square >> 13) >> 3) + (word(4) * t >> 1)) >> 18;
    const uint32_t divisor =
        static_cast<uint32_t>(32768 + slope) * static_cast<uint32_t>(static_cast<uint16_t>(word(3))) >> 15;
    pascals_ = 0;
    if (divisor == 0) return;
    const uint32_t p = static_cast<uint32_t>(1048576 - raw - (offset >> 12)) * 3125;
    const int32_t pascals = static_cast<int32_t>(p < 0x80000000UL ? p * 2 / divisor : p / divisor * 2);
    const int32_t bend = word(11) * ((pascals >> 3) * (pascals >> 3) >> 13) >> 12;
    pascals_ = pascals + ((bend + ((pascals >> 2) * word(10) >> 13) + word(9)) >> 4);
}

void Weather::convertHumidity(int32_t raw, int32_t fine) {
    const uint8_t* const h = calibration_ + kFirstBytes;
    const int32_t h1 = calibration_[kFirstBytes - 1], h2 = static_cast<int16_t>(h[1] << 8 | h[0]), h3 = h[2];
    const int32_t h4 = static_cast<int8_t>(h[3]) * 16 | (h[4] & 15),
                  h5 = static_cast<int8_t>(h[5]) * 16 | h[4] >> 4;
    const int32_t h6 = static_cast<int8_t>(h[6]);
    const int32_t t = fine - 76800;
    const int32_t scale = ((t * h6 >> 10) * ((t * h3 >> 11) + 32768) >> 10) + 2097152;
    int32_t value = (((raw << 14) - h4 * 1048576L - h5 * t + 16384) >> 15) * ((scale * h2 + 8192) >> 14);
    value -= ((value >> 15) * (value >> 15) >> 7) * h1 >> 4;
    if (value < 0) value = 0;
    if (value > 419430400L) value = 419430400L;
    humidity_ = static_cast<uint16_t>((value >> 12) * 25 >> 8);
}

void Weather::reportValue(uint8_t index) {
    if (index == 0) return out.hundredths(temperature_);
    if (index == 2) return out.hundredths(pascals_);
    if (hasHumidity_) out.hundredths(humidity_);
}

}  // namespace asip

#endif
