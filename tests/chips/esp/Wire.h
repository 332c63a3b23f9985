// SPDX-License-Identifier: Apache-2.0
// I2C as both cores of Espressif declare it, each with the overloads of its own.
#pragma once

#include <Arduino.h>

class TwoWire : public Stream {
  public:
    void begin();
    void begin(uint8_t address);
    void beginTransmission(uint8_t address);
    uint8_t endTransmission();
#ifdef ESP8266
    void begin(int sda, int scl);
    void begin(int address);
    void beginTransmission(int address);
    uint8_t endTransmission(uint8_t stop);
    size_t requestFrom(uint8_t address, size_t size, bool stop);
    uint8_t requestFrom(uint8_t address, uint8_t size);
    uint8_t requestFrom(uint8_t address, uint8_t size, uint8_t stop);
    uint8_t requestFrom(int address, int size);
    uint8_t requestFrom(int address, int size, int stop);
#else
#define WIRE_HAS_END 1
    void end();
    bool begin(int sda, int scl, uint32_t frequency = 0);
    uint8_t endTransmission(bool stop);
    size_t requestFrom(uint8_t address, size_t size, bool stop);
    size_t requestFrom(uint8_t address, size_t size);
#endif
    size_t write(uint8_t byte) override;
    size_t write(const uint8_t* bytes, size_t size) override;
    int available() override;
    int read() override;
    int peek() override;
    using Print::write;
};
extern TwoWire Wire;
