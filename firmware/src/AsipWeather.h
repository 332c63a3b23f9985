// SPDX-License-Identifier: Apache-2.0
// A sensor of temperature, humidity and air pressure, the BME280 on the I2C bus, or of temperature and
// pressure, the BMP280:
//
//   asip::Weather weather;          // at 0x76; asip::Weather weather(0x77) at the other address
//
// W,M measures once, W,A,ms periodically; both are answered by @W,e,3,{21.50,45.20,1013.25}: degrees Celsius,
// percent, which a BMP280 leaves out, and hectopascals (millibars). A measurement takes 12 ms; the sketch
// does not wait for it. A chip that is missing, or another one, is error 8, pins in use elsewhere 9.
#pragma once

#include "Asip.h"
#include "asip/I2cSensor.h"

namespace asip {

class Weather : public I2cSensor {
  public:
    explicit Weather(uint8_t address = 0x76) : I2cSensor('W', 3, 3), address_(address) {}

    FlashText name() const override;
    void reportValue(uint8_t index) override;

  protected:
    Outcome doStep(uint8_t step) override;

  private:
    // As the chip keeps them: T1 to T3, P1 to P9 and, with a byte between, H1; then H2 to H6.
    static constexpr uint8_t kWords = 12, kFirstBytes = 26, kHumidityBytes = 7;

    Outcome convert();
    int16_t word(uint8_t index) const {
        return static_cast<int16_t>(calibration_[2 * index + 1] << 8 | calibration_[2 * index]);
    }
    int32_t convertTemperature(int32_t raw);
    void convertPressure(int32_t raw, int32_t fine);
    void convertHumidity(int32_t raw, int32_t fine);

    uint8_t calibration_[kFirstBytes + kHumidityBytes];
    uint8_t raw_[8];
    uint8_t address_;
    bool hasHumidity_;
    int16_t temperature_;  // hundredths
    uint16_t humidity_;    // hundredths
    int32_t pascals_;
};

}  // namespace asip
