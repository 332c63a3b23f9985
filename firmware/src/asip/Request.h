// SPDX-License-Identifier: Apache-2.0
// One request line, read argument by argument. A service reads all its arguments, then asks once whether
// they were all there and well-formed, and acts only then:
//
//   const uint16_t servo = request.number();
//   const uint16_t angle = request.number(180);
//   if (!request.complete()) return Error::kBadArgument;
#pragma once

#include <stdint.h>

namespace asip {

class Request {
  public:
    // `line` ends in '\0', lasts as long as the request, and has at least `S,t`.
    explicit Request(const char* line) : next_(line + 3), tag_(line[2]), good_(true) {}

    char tag() const { return tag_; }

    // The next argument: a comma and digits. Blanks before and after it, and what follows a decimal point,
    // do not count. A missing or malformed one, or one above `max`, spoils the request and reads as 0.
    uint16_t number(uint16_t max = 65535) { return argument(max, false); }

    // The same with an optional minus; the magnitude is at most `max`.
    int16_t signedNumber(int16_t max = 32767) { return signedArgument(max, false); }

    // The same, but one beyond the bounds (0 and `max`, -`max` and `max`) reads as the bound.
    uint16_t clampedNumber(uint16_t max);
    int16_t clampedSignedNumber(int16_t max) { return signedArgument(max, true); }

    // True if there is another argument.
    bool more() const { return good_ && *next_ == ','; }

    // The rest of the line after a comma, as text; empty if there is none. One that no comma begins spoils
    // the request: it belongs to the argument before.
    const char* text();

    // True if every argument asked for was good and nothing is left over.
    bool complete() const { return good_ && *next_ == '\0'; }

    // The number here, up to `max`, which no comma begins: an item of a list.
    uint32_t item(uint32_t max);

    // Steps over `expected`, which has to be the next character.
    void expect(char expected) {
        if (!skip(expected)) good_ = false;
    }

    // True if every argument asked for so far was good.
    bool good() const { return good_; }

    // Steps over `expected` if it is the next character.
    bool skip(char expected);

  private:
    inline void begin() __attribute__((always_inline));
    uint16_t digits(uint16_t max, bool clamp);
    uint16_t argument(uint16_t max, bool clamp);
    int16_t signedArgument(int16_t max, bool clamp);

    const char* next_;
    char tag_;
    bool good_;
};

}  // namespace asip
