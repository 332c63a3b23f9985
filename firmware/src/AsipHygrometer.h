// SPDX-License-Identifier: Apache-2.0
// A sensor of temperature and humidity, the SHT31 (SHT30, SHT35) on the I2C bus:
//
//   asip::Hygrometer air;          // at 0x44; asip::Hygrometer air(0x45) where its pin ADDR is high
//
// Q,M measures once, Q,A,ms periodically; both are answered by @Q,e,2,{21.50,45.20}, degrees Celsius and
// percent. A measurement whose checksum is wrong has no values, @Q,e,2,{,}, and Q,E asks how often that was,
// @Q,E,1,{3}. A measurement takes 16 ms; the sketch does not wait for it. A chip that is missing is error 8,
// pins in use elsewhere 9.
#pragma once

#include "Asip.h"
#include "asip/I2cSensor.h"

namespace asip {

class Hygrometer : public I2cSensor {
  public:
    explicit Hygrometer(uint8_t address = 0x44) : I2cSensor('Q', 2, 2), address_(address) {}

    FlashText name() const override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;

  protected:
    Outcome doStep(uint8_t step) override;

  private:
    static uint8_t checksum(const uint8_t* word);

    uint8_t address_;
    bool isDamaged_;
    uint8_t damaged_;  // measurements, counted up to 255
    uint8_t raw_[6];   // temperature and humidity, each with its checksum
};

}  // namespace asip
