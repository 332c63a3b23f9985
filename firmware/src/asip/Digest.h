// SPDX-License-Identifier: Apache-2.0
// CRC-16/CCITT, reflected (polynomial 0x8408), of one more byte.
#pragma once

#include "Hardware.h"

#if defined(__AVR__)
#include <util/crc16.h>  // a third of the cycles that the compiler needs for the lines below

namespace asip {
inline uint16_t digestOf(uint16_t digest, uint8_t byte) {
    return _crc_ccitt_update(digest, byte);
}
}  // namespace asip

#else

namespace asip {
inline uint16_t digestOf(uint16_t digest, uint8_t byte) {
    uint8_t x = static_cast<uint8_t>(byte ^ digest);
    x ^= static_cast<uint8_t>(x << 4);
    return static_cast<uint16_t>((static_cast<uint16_t>(x) << 8 | digest >> 8) ^ x >> 4 ^
                                 static_cast<uint16_t>(x) << 3);
}
}  // namespace asip

#endif
