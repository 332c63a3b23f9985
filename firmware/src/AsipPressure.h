// SPDX-License-Identifier: Apache-2.0
// A pressure sensor, the BMP085 at 0x77 on the I2C bus:
//
//   asip::Pressure pressure;
//
// P,M measures once, P,A,ms periodically; both are answered by @P,e,3,{1013.25,21.50,0.00}: hectopascals
// (millibars), degrees Celsius, and the metres above sea level that would have this pressure in the standard
// atmosphere. A measurement takes 40 ms; the sketch does not wait for it. A chip that is missing is error 8,
// pins in use elsewhere 9.
#pragma once

#include "Asip.h"
#include "asip/I2cSensor.h"

namespace asip {

class Pressure : public I2cSensor {
  public:
    Pressure() : I2cSensor('P', 3, 1) {}

    FlashText name() const override;
    void reportValue(uint8_t index) override;

  protected:
    Outcome doStep(uint8_t step) override;

  private:
    static constexpr uint8_t kWords = 11;

    int16_t word(uint8_t index) const {
        return static_cast<int16_t>(calibration_[2 * index] << 8 | calibration_[2 * index + 1]);
    }
    void convertTemperature();
    void convertPressure();

    uint8_t calibration_[2 * kWords];
    uint8_t raw_[3];
    int32_t b5_;  // of the data sheet: the temperature in a finer measure
    int32_t pascals_;
};

}  // namespace asip
