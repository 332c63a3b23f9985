// SPDX-License-Identifier: Apache-2.0
#include "PixelStrip.h"

#ifdef __AVR__
#include <Arduino.h>

#include "asip/Board.h"

namespace asip {

// From the data sheets of WS2812 and WS2812B, which differ; these times suit both. A bit begins with a rise:
// 0 falls after 0.375 us, 1 after 0.75 us, the next follows after 1.25 us. A pixel that gets no bit for 50 us
// takes what it has; newer ones want 280 us.
static constexpr uint16_t kLatchMicroseconds = 300;
static constexpr uint8_t kMaxGapTicks = F_CPU / 1000000 * 40 / 64;  // 40 us of timer 0

#if F_CPU == 8000000L
// One bit, while the next is looked at; written out, so that the compiler knows how long it is.
#define ASIP_BIT(next_bit)                             \
    "st %a[port], %[high]\n" /* 0 */                   \
    "nop\n"                                            \
    "st %a[port], %[next]\n" /* 0 falls at 3 cycles */ \
    "mov %[next], %[low]\n"                            \
    "st %a[port], %[low]\n" /* 1 falls at 6 */         \
    "sbrc %[byte], " #next_bit                         \
    "\n"                                               \
    "mov %[next], %[high]\n" /* 10 */
#endif

// Eight bits, the highest first, exact to the cycle.
static inline void sendByte(volatile uint8_t* port, uint8_t high, uint8_t low, uint8_t byte) {
    uint8_t next;
#if F_CPU == 16000000L
    uint8_t bits;
    asm volatile(
        "ldi %[bits], 8\n"
        "1: st %a[port], %[high]\n"  // rises at 0
        "mov %[next], %[low]\n"
        "sbrc %[byte], 7\n"
        "mov %[next], %[high]\n"
        "nop\n"
        "st %a[port], %[next]\n"  // 0 falls at 6 cycles
        "lsl %[byte]\n"
        "rjmp .+0\n"
        "nop\n"
        "st %a[port], %[low]\n"  // 1 falls at 12
        "rjmp .+0\n"
        "nop\n"
        "dec %[bits]\n"
        "brne 1b\n"  // 20
        : [next] "=&r"(next), [bits] "=&d"(bits), [byte] "+r"(byte)
        : [port] "e"(port), [high] "r"(high), [low] "r"(low));
#elif F_CPU == 8000000L
    asm volatile(
        "mov %[next], %[low]\n"
        "sbrc %[byte], 7\n"
        "mov %[next], %[high]\n" ASIP_BIT(6) ASIP_BIT(5) ASIP_BIT(4) ASIP_BIT(3) ASIP_BIT(2) ASIP_BIT(1)
            ASIP_BIT(0) ASIP_BIT(0)
        : [next] "=&r"(next), [byte] "+r"(byte)
        : [port] "e"(port), [high] "r"(high), [low] "r"(low));
#else
#error "PixelStrip knows the times of pixels at 16 and 8 MHz"
#endif
}

void PixelStrip::begin(const Service& service) {
    for (uint16_t i = 0; i < 3 * count_; ++i)
        colors_[i] = 0;
    brightness_ = 255;
    wanted_ = board.claimPin(pin_, service) == Error::kNone;
    if (wanted_) pinMode(pin_, OUTPUT);
}

bool PixelStrip::isAvailable(const Service& service) const {
    return board.ownsPin(pin_, service);
}

void PixelStrip::set(uint8_t pixel, uint8_t red, uint8_t green, uint8_t blue) {
    uint8_t* const color = colors_ + 3 * pixel;
    color[0] = green;
    color[1] = red;
    color[2] = blue;
}

void PixelStrip::poll() {
    if (!wanted_ || static_cast<uint16_t>(micros() - since_) < kLatchMicroseconds) return;
    wanted_ = !send();
    since_ = static_cast<uint16_t>(micros());
}

// Interrupts are off for one byte, 11 us, and are served between two of them. False if they took so long that
// the pixels may have shown half of it.
bool PixelStrip::send() const {
    volatile uint8_t* const port = portOutputRegister(digitalPinToPort(pin_));
    const uint8_t mask = digitalPinToBitMask(pin_);
    const uint8_t* next = colors_;
    uint8_t sent = TCNT0;
    for (uint16_t left = 3 * count_; left > 0; --left) {
        const uint8_t byte = static_cast<uint8_t>(*next++ * (brightness_ + 1) >> 8);
        noInterrupts();
        const uint8_t now = TCNT0;
        const uint8_t gap = static_cast<uint8_t>(now - sent);
        const uint8_t latch = *port;
        if (gap <= kMaxGapTicks) sendByte(port, latch | mask, latch & ~mask, byte);
        sent = TCNT0;
        interrupts();
        if (gap > kMaxGapTicks) return false;
    }
    return true;
}

}  // namespace asip

#endif
