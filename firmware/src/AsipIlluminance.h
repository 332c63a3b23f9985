// SPDX-License-Identifier: Apache-2.0
// A sensor of light, the BH1750 on the I2C bus:
//
//   asip::Illuminance light;        // at 0x23; asip::Illuminance light(0x5C) where its pin ADDR is high
//
// U,M measures once, U,A,ms periodically; both are answered by @U,e,1,{347.50}, lux, up to 54612.50. A
// measurement takes 0.2 seconds; the sketch does not wait for it. A chip that is missing is error 8, pins in
// use elsewhere 9.
#pragma once

#include "Asip.h"
#include "asip/I2cSensor.h"

namespace asip {

class Illuminance : public I2cSensor {
  public:
    explicit Illuminance(uint8_t address = 0x23) : I2cSensor('U', 1, 1), address_(address) {}

    FlashText name() const override;
    void reportValue(uint8_t index) override;

  protected:
    Outcome doStep(uint8_t step) override;

  private:
    uint8_t address_;
    uint8_t raw_[2];
};

}  // namespace asip
