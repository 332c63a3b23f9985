// SPDX-License-Identifier: Apache-2.0
// Motion sensors on the I2C bus (pins A4 and A5 of an Uno), which report as they measure:
//
//   asip::Motion accelerometer(asip::Motion::kAccelerometer);  // MPU-6050 at 0x68, +-2 g
//   asip::Motion gyroscope(asip::Motion::kGyroscope);  // the same chip, +-250 degrees a second
//   asip::Motion heading(asip::Motion::kHeading);  // HMC5883L at 0x1E
//
// A,M, G,M and H,M measure once, A,A,ms, G,A,ms and H,A,ms periodically. @A,e,3,{x,y,z} and @G,e,3,{x,y,z}
// are the chip's numbers, @H,e,4,{x,y,z,degrees} adds the direction in which the field points, 0 to 359. On
// an AVR the sketch does not wait for the chip. A chip that is missing is error 8, pins in use elsewhere 9.
#pragma once

#include "Asip.h"
#include "asip/I2cSensor.h"

namespace asip {

class Motion : public I2cSensor {
  public:
    enum Kind : uint8_t { kAccelerometer = 'A', kGyroscope = 'G', kHeading = 'H' };

    explicit Motion(Kind kind) : I2cSensor(static_cast<char>(kind), kind == kHeading ? 4 : 3, 1) {}

    FlashText name() const override;
    void reportValue(uint8_t index) override;

  protected:
    Outcome doStep(uint8_t step) override;

  private:
    int16_t axis(uint8_t index) const;

    uint8_t bytes_[6];  // as the chip sends them
};

}  // namespace asip
