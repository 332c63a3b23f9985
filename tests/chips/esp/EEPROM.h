// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Arduino.h>

class EEPROMClass {
  public:
    ASIP_BEGUN begin(size_t size);
    uint8_t read(int address);
    void write(int address, uint8_t value);
    bool commit();
};
extern EEPROMClass EEPROM;
