// SPDX-License-Identifier: Apache-2.0
// Base of the services that measure with a chip on the I2C bus. It finds the chip, sets it up and reads it,
// step by step in the loop; a chip that is not there is looked for again at each request and each period, and
// reports go on once it is back. M and A are answered by error 8 while it is not there, by 9 where the bus
// has no pins; a measurement that fails on its way is error 8 with the tag of its event.
#pragma once

#include "Asip.h"
#include "I2c.h"

namespace asip {

class I2cSensor : public Service {
  public:
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValues() override;  // starts to measure
    void poll() override;          // goes on measuring, and reports at the end

  protected:
    enum Outcome : uint8_t { kGoOn, kNextStep, kMeasured, kNotThere };

    // A sensor has to be a global: what is not set here is zero.
    I2cSensor(char id, uint8_t values, uint8_t setUpSteps)
        : Service(id, values), values_(values), setUpSteps_(setUpSteps) {}

    // Steps count from 0. The first `setUpSteps` set the chip up, once; the others measure. Called again and
    // again, for each step, until it is not kGoOn.
    virtual Outcome doStep(uint8_t step) = 0;

    // doStep() returns its result: it begins the transfer (I2c::start) or looks for its end. kNextStep once
    // the transfer is over.
    Outcome transfer(uint8_t address, uint8_t first, const uint8_t* out, uint8_t outCount, uint8_t* in,
                     uint8_t inCount);

    // doStep() returns its result: kNextStep once so many milliseconds have passed, 250 at most.
    Outcome wait(uint8_t milliseconds);

  private:
    enum State : uint8_t { kIdle, kSettingUp, kMeasuring, kReporting, kFailing };
    void start(bool asked);
    void failed();

    uint8_t values_;
    uint8_t setUpSteps_;
    uint8_t step_;
    uint8_t state_;
    uint8_t sinceMs_;
    bool isReady_;    // the chip is there and set up
    bool isAsked_;    // by M: to be answered, whatever comes
    bool isWaiting_;  // for the end of a transfer or a time
};

}  // namespace asip
