// SPDX-License-Identifier: Apache-2.0
#include "Out.h"

#include "Line.h"

namespace asip {

Out out;

void Out::character(char c) {
    if (kExtensions) checksum_ ^= static_cast<uint8_t>(c);
    line::write(static_cast<uint8_t>(c));
}

void Out::text(FlashText text) {
    const char* next = reinterpret_cast<const char*>(text);
    while (char c = static_cast<char>(pgm_read_byte(next++)))
        character(c);
}

void Out::text(const char* text) {
    while (char c = *text++)
        character(c);
}

void Out::digits(uint16_t value, uint8_t point) {
    // By subtraction: a division by ten takes 200 cycles on AVR, more than a byte at 1,000,000 baud.
    static const uint16_t kPowers[] PROGMEM = {10000, 1000, 100, 10};
    bool leading = true;
    for (uint8_t i = 0; i < 4; ++i) {
        const uint16_t power = pgm_read_word(&kPowers[i]);
        char digit = '0';
        while (value >= power) {
            value -= power;
            ++digit;
        }
        const bool isBeforePoint = i == point;
        if (digit != '0' || isBeforePoint) leading = false;
        if (!leading) character(digit);
        if (isBeforePoint) character('.');
    }
    character(static_cast<char>('0' + value));
}

void Out::pair(uint8_t first, uint8_t second) {
    number(first);
    character(':');
    number(second);
}

void Out::signedDigits(int16_t value, uint8_t point) {
    uint16_t magnitude = static_cast<uint16_t>(value);
    if (value < 0) {
        character('-');
        magnitude = static_cast<uint16_t>(-magnitude);
    }
    digits(magnitude, point);
}

void Out::longNumber(uint32_t value) {
    char digits[10];
    uint8_t count = 0;
    do {
        digits[count++] = static_cast<char>('0' + value % 10);
        value /= 10;
    } while (value != 0);
    while (count != 0)
        character(digits[--count]);
}

void Out::signedLongNumber(int32_t value) {
    uint32_t magnitude = static_cast<uint32_t>(value);
    if (value < 0) {
        character('-');
        magnitude = 0 - magnitude;
    }
    longNumber(magnitude);
}

void Out::hundredths(int32_t value) {
    uint32_t magnitude = static_cast<uint32_t>(value);
    if (value < 0) {
        character('-');
        magnitude = 0 - magnitude;
    }
    longNumber(magnitude / 100);
    const uint8_t rest = static_cast<uint8_t>(magnitude % 100);
    character('.');
    character(static_cast<char>('0' + rest / 10));
    character(static_cast<char>('0' + rest % 10));
}

void Out::hexDigit(uint8_t value) {
    if (value > 9) value = static_cast<uint8_t>(value + 'A' - '0' - 10);
    character(static_cast<char>('0' + value));
}

void Out::hexByte(uint8_t value) {
    if (value >= 16) hexDigit(value >> 4);
    hexDigit(value & 15);
}

void Out::head(char kind, char service, char tag) {
    character(kind);
    character(service);
    character(',');
    character(tag);
    character(',');
}

void Out::event(char service, char tag) {
    character('@');
    character(service);
    character(',');
    character(tag);
}

void Out::answer(char service, char tag) {
    head('@', service, tag);
}

void Out::error(char service, char tag, Error error) {
    head('~', service, tag);
    number(static_cast<uint8_t>(error));
    character('{');
    text(errorText(error));
    character('}');
    end();
}

void Out::end() {
    if (kExtensions && checksumOn_) {
        const uint8_t sum = checksum_;
        character('*');
        hexDigit(sum >> 4);
        hexDigit(sum & 15);
    }
    character('\n');
    checksum_ = 0;
}

bool Out::hasRoomForPiece() const {
    return line::room() >= kLongestPiece;
}

}  // namespace asip
