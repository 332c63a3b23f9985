#include "Request.h"

namespace asip {

uint16_t Request::digits(uint16_t max) {
    const char* next = next_;
    uint16_t value = 0;
    uint8_t digit = static_cast<uint8_t>(*next - '0');
    if (digit > 9) good_ = false;
    while (digit <= 9) {
        if (value > 6553 || (value == 6553 && digit > 5)) good_ = false;
        value = static_cast<uint16_t>(value * 10 + digit);
        digit = static_cast<uint8_t>(*++next - '0');
    }
    next_ = next;
    if (value > max) good_ = false;
    return good_ ? value : 0;
}

bool Request::skip(char expected) {
    if (*next_ != expected) return false;
    ++next_;
    return true;
}

uint16_t Request::number(uint16_t max) {
    if (!skip(',')) good_ = false;
    return digits(max);
}

int16_t Request::signedNumber(int16_t max) {
    if (!skip(',')) good_ = false;
    const bool negative = skip('-');
    const int16_t magnitude = static_cast<int16_t>(digits(static_cast<uint16_t>(max)));
    return negative ? static_cast<int16_t>(-magnitude) : magnitude;
}

const char* Request::text() {
    skip(',');
    const char* begin = next_;
    while (*next_ != '\0')
        ++next_;
    return begin;
}

}  // namespace asip
