// SPDX-License-Identifier: Apache-2.0
// An input pin that an interrupt reads: on AVR in a few cycles, elsewhere by digitalRead().
#pragma once

#include <Arduino.h>

namespace asip {

class QuickPin {
  public:
#ifdef __AVR__
    constexpr QuickPin() : input_(nullptr), mask_(0) {}
    explicit QuickPin(uint8_t pin)
        : input_(portInputRegister(digitalPinToPort(pin))), mask_(digitalPinToBitMask(pin)) {}

    bool isConnected() const { return mask_ != 0; }
    bool isHigh() const { return *input_ & mask_; }

  private:
    volatile uint8_t* input_;
    uint8_t mask_;
#else
    constexpr QuickPin() : pin_(kNone) {}
    explicit QuickPin(uint8_t pin) : pin_(pin) {}

    // Inline where an interrupt calls them, wherever that is kept.
    bool isConnected() const __attribute__((always_inline)) { return pin_ != kNone; }
    bool isHigh() const __attribute__((always_inline)) { return digitalRead(pin_) == HIGH; }

  private:
    static constexpr uint8_t kNone = 255;
    uint8_t pin_;
#endif
};

}  // namespace asip
