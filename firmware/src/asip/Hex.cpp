// SPDX-License-Identifier: Apache-2.0
#include "Hex.h"

namespace asip {

void writeHex(const uint8_t* bytes, uint8_t count) {
    for (; count != 0; --count) {
        const uint8_t byte = *bytes++;
        if (byte < 16) out.character('0');
        out.hexByte(byte);
    }
}

uint8_t hexValue(char c) {
    const uint8_t digit = static_cast<uint8_t>(c - '0');
    if (digit < 10) return digit;
    const uint8_t letter = static_cast<uint8_t>((c | 0x20) - 'a');
    return letter < 6 ? static_cast<uint8_t>(letter + 10) : 255;
}

bool readHex(const char* text, uint8_t* bytes, uint8_t room, uint8_t& count) {
    for (count = 0; *text != '\0'; ++count) {
        if (count == room) return false;
        const uint8_t high = hexValue(*text++);
        if (high == 255) return false;
        const uint8_t low = hexValue(*text++);
        if (low == 255) return false;
        bytes[count] = static_cast<uint8_t>(high << 4 | low);
    }
    return true;
}

}  // namespace asip
