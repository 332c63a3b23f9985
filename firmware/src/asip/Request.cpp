#include "Request.h"

namespace asip {

// Reads digits from `next` on.
uint16_t Request::digits(const char* next, uint16_t max) {
    uint8_t digit = static_cast<uint8_t>(*next - '0');
    bool good = digit <= 9;
    uint16_t value = digit;
    while (digit <= 9) {
        digit = static_cast<uint8_t>(*++next - '0');
        if (digit > 9) break;
        if (value >= 6553 && (value > 6553 || digit > 5)) good = false;
        value = static_cast<uint16_t>(value * 10 + digit);
    }
    next_ = next;
    if (good && value <= max) return value;
    good_ = false;
    return 0;
}

uint16_t Request::number(uint16_t max) {
    const char* const next = next_;
    if (*next == ',') return digits(next + 1, max);
    good_ = false;
    return 0;
}

int16_t Request::signedNumber(int16_t max) {
    if (next_[0] != ',' || next_[1] != '-') return static_cast<int16_t>(number(static_cast<uint16_t>(max)));
    return static_cast<int16_t>(-static_cast<int16_t>(digits(next_ + 2, static_cast<uint16_t>(max))));
}

bool Request::skip(char expected) {
    if (*next_ != expected) return false;
    ++next_;
    return true;
}

const char* Request::text() {
    skip(',');
    const char* begin = next_;
    while (*next_ != '\0')
        ++next_;
    return begin;
}

}  // namespace asip
