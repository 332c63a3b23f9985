// SPDX-License-Identifier: Apache-2.0
#include "Request.h"

namespace asip {

inline void Request::begin() {
    if (!skip(',')) good_ = false;
    while (skip(' ')) {
    }
}

uint16_t Request::digits(uint16_t max, bool clamp) {
    const char* next = next_;
    uint8_t digit = static_cast<uint8_t>(*next - '0');
    if (digit > 9) good_ = false;
    bool fits = true;
    uint16_t value = 0;
    while (digit <= 9) {
        if (value >= 6553 && (value > 6553 || digit > 5)) fits = false;
        value = static_cast<uint16_t>(value * 10 + digit);
        digit = static_cast<uint8_t>(*++next - '0');
    }
    if (*next == '.') {
        while (static_cast<uint8_t>(*++next - '0') <= 9) {
        }
    }
    while (*next == ' ')
        ++next;
    next_ = next;
    if (fits && value <= max) return value;
    if (clamp) return max;
    good_ = false;
    return 0;
}

uint16_t Request::argument(uint16_t max, bool clamp) {
    begin();
    return digits(max, clamp);
}

uint16_t Request::clampedNumber(uint16_t max) {
    begin();
    const bool negative = skip('-');
    const uint16_t value = digits(max, true);
    return negative ? 0 : value;
}

int16_t Request::signedArgument(int16_t max, bool clamp) {
    begin();
    const bool negative = skip('-');
    const int16_t value = static_cast<int16_t>(digits(static_cast<uint16_t>(max), clamp));
    return negative ? static_cast<int16_t>(-value) : value;
}

uint32_t Request::item(uint32_t max) {
    while (skip(' ')) {
    }
    uint8_t digit = static_cast<uint8_t>(*next_ - '0');
    if (digit > 9) good_ = false;
    uint32_t value = 0;
    while (digit <= 9) {
        value = value * 10 + digit;
        if (value > max) {
            good_ = false;
            value = 0;
        }
        digit = static_cast<uint8_t>(*++next_ - '0');
    }
    while (skip(' ')) {
    }
    return value;
}

bool Request::skip(char expected) {
    if (*next_ != expected) return false;
    ++next_;
    return true;
}

const char* Request::text() {
    if (*next_ != '\0') expect(',');
    const char* begin = next_;
    while (*next_ != '\0')
        ++next_;
    return begin;
}

}  // namespace asip
