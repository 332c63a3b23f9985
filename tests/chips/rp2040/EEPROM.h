// SPDX-License-Identifier: Apache-2.0
// What the cores of chips without EEPROM call so: bytes in memory, which commit() writes into the last sector
// of the flash.
#pragma once

#include <stddef.h>
#include <stdint.h>

class EEPROMClass {
  public:
    void begin(size_t size);
    uint8_t read(int address) { return bytes_[address]; }
    void write(int address, uint8_t value) { bytes_[address] = value; }
    bool commit();

  private:
    static constexpr size_t kMaxSize = 512;
    uint8_t bytes_[kMaxSize];
};
extern EEPROMClass EEPROM;
