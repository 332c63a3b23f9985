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

constexpr bool isPlainText(const char* text) {
    return *text == 0 || (*text >= 0x20 && *text < 0x7f && isPlainText(text + 1));
}

template <bool plain>
inline FlashText checkedName(FlashText name) {
    static_assert(plain, "a name of a sketch or service is plain ASCII: no letters such as e with an accent");
    return name;
}

// A name in flash: ASIP_NAME("Fan"), as F("Fan"), but anything outside ASCII does not compile. Lines of the
// protocol are ASCII; hosts may take other bytes for damage.
#define ASIP_NAME(text) (asip::checkedName<asip::isPlainText(text)>(F(text)))

inline FlashText flashText(const char* inFlash) {
    return reinterpret_cast<FlashText>(inFlash);
}

}  // namespace asip
