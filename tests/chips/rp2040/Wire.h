// SPDX-License-Identifier: Apache-2.0
// The first I2C bus of the chip as Arduino cores offer it: each call waits for its end.
#pragma once

#include <Arduino.h>

#define WIRE_HAS_END 1

class TwoWire {
  public:
    // Does nothing while it runs already, as in the core that people install.
    void begin();
    void end();
    void beginTransmission(uint8_t address);
    size_t write(uint8_t byte);
    uint8_t endTransmission(bool stop = true);
    size_t requestFrom(uint8_t address, size_t count, bool stop);
    size_t requestFrom(uint8_t address, size_t count) { return requestFrom(address, count, true); }
    int read();

  private:
    static constexpr uint8_t kSize = 64;

    void address(uint8_t chip);
    bool waitFor(uint32_t address, uint32_t bits);
    bool isAborted();
    void finish();

    uint8_t bytes_[kSize];
    uint8_t count_, next_, address_;
    bool isOpen_;  // no stop yet
    bool runs_;
};
extern TwoWire Wire;
