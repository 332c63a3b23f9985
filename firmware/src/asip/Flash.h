// SPDX-License-Identifier: Apache-2.0
// Text and tables that stay in flash on AVR, and are plain constants on the host.
#pragma once

#include <stdint.h>

#ifdef ARDUINO
#include <Arduino.h>
#ifdef __AVR__
#include <avr/pgmspace.h>
#endif
#else
#define PROGMEM
class __FlashStringHelper;
#define F(text) (reinterpret_cast<const __FlashStringHelper*>(text))
#define pgm_read_byte(address) (*reinterpret_cast<const uint8_t*>(address))
#define pgm_read_word(address) (*reinterpret_cast<const uint16_t*>(address))
#endif

namespace asip {

// A text in flash, as made by F("...").
typedef const __FlashStringHelper* FlashText;

inline FlashText flashText(const char* inFlash) {
    return reinterpret_cast<FlashText>(inFlash);
}

}  // namespace asip
