// SPDX-License-Identifier: Apache-2.0
#include "Error.h"

namespace asip {

// One text after the other, in the order of the numbers: a table of pointers would cost 24 bytes more.
static const char kTexts[] PROGMEM =
    "NO_ERROR\0"
    "INVALID_SERVICE\0"
    "UNKNOWN_REQUEST\0"
    "INVALID_PIN\0"
    "MODE_UNAVAILABLE\0"
    "INVALID_MODE\0"
    "WRONG_MODE\0"
    "INVALID_DEVICE_NUMBER\0"
    "DEVICE_NOT_AVAILABLE\0"
    "I2C_NOT_ENABLED\0"
    "BAD_CHECKSUM\0"
    "BAD_ARGUMENT";

FlashText errorText(Error error) {
    const char* text = kTexts;
    for (uint8_t skip = static_cast<uint8_t>(error); skip > 0; --skip) {
        while (pgm_read_byte(text++) != 0) {
        }
    }
    return flashText(text);
}

}  // namespace asip
