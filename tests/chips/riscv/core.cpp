// SPDX-License-Identifier: Apache-2.0
// The Arduino core's functions on a FE310 (RV32IMAC), by its manual: GPIO, UART, and its timer as the clock.
// Nothing is done by interrupts: bytes, tones and pins are looked at between two calls of loop(), or when
// they are asked for.
#include <Arduino.h>

#include "core/runtime.h"

static constexpr uint32_t kGpio = 0x10012000, kUart = 0x10013000;
static constexpr uint32_t kIn = kGpio, kInEnable = kGpio + 0x04, kOutEnable = kGpio + 0x08,
                          kOut = kGpio + 0x0c;
static constexpr uint32_t kPullUp = kGpio + 0x10, kFunction = kGpio + 0x38;
static constexpr uint32_t kSend = kUart, kReceive = kUart + 0x04, kSendControl = kUart + 0x08,
                          kReceiveControl = kUart + 0x0c;
static constexpr uint32_t kDivisor = kUart + 0x18, kUartPins = 3u << 16;
static constexpr uint32_t kNotNow = 1u << 31;  // full, or nothing received

// The timer's: 10 MHz in the emulator, 32768 Hz on the chip.
static constexpr uint32_t kTicksPerMicrosecond = 10;
static constexpr uint32_t kCompareLow = 0x02004000, kCompareHigh = 0x02004004, kTimeLow = 0x0200bff8,
                          kTimeHigh = 0x0200bffc;

static volatile uint32_t& at(uint32_t address) {
    return *reinterpret_cast<volatile uint32_t*>(address);
}
static void change(uint32_t address, pin_size_t pin, bool on) {
    const uint32_t bit = 1u << pin;
    at(address) = on ? at(address) | bit : at(address) & ~bit;
}

extern "C" {
extern uint32_t stackTop[];
__attribute__((naked, section(".vectors"))) void reset() {
    asm volatile("la sp, stackTop\n j startOnChip");
}
__attribute__((used)) void startOnChip() {
    startProgram();
}
}

static uint64_t ticks() {
    uint32_t high, low;
    do {
        high = at(kTimeHigh);
        low = at(kTimeLow);
    } while (high != at(kTimeHigh));
    return static_cast<uint64_t>(high) << 32 | low;
}
unsigned long micros() {
    return static_cast<unsigned long>(ticks() / kTicksPerMicrosecond);
}
unsigned long millis() {
    return static_cast<unsigned long>(ticks() / (1000 * kTicksPerMicrosecond));
}

// The timer wakes a chip that waits, and calls nothing: interrupts stay off.
void startChip() {
    asm volatile("csrw mie, %0" : : "r"(1u << 7));
}
static void waitMicroseconds(uint32_t microseconds) {
    const uint64_t end = ticks() + microseconds * kTicksPerMicrosecond;
    at(kCompareHigh) = ~0u;
    at(kCompareLow) = static_cast<uint32_t>(end);
    at(kCompareHigh) = static_cast<uint32_t>(end >> 32);
    asm volatile("wfi");
}
void delayMicroseconds(unsigned int microseconds) {
    const unsigned long since = micros();
    while (micros() - since < microseconds) {
    }
}

void pinMode(pin_size_t pin, PinMode mode) {
    change(kPullUp, pin, mode == INPUT_PULLUP);
    change(kOutEnable, pin, mode == OUTPUT);
    change(kInEnable, pin, true);
}
void digitalWrite(pin_size_t pin, PinStatus level) {
    change(kOut, pin, level != LOW);
}
PinStatus digitalRead(pin_size_t pin) {
    return at(kIn) >> pin & 1 ? HIGH : LOW;
}
int analogRead(pin_size_t) {
    return 0;
}
// As on other cores, where a pin has no PWM.
void analogWrite(pin_size_t pin, int duty) {
    pinMode(pin, OUTPUT);
    digitalWrite(pin, duty > 127 ? HIGH : LOW);
}

void noInterrupts() {}
void interrupts() {}

static void (*handlers[NUM_DIGITAL_PINS])();
static uint32_t watched, levels;

void attachInterrupt(pin_size_t pin, void (*handler)(), PinStatus) {
    handlers[pin] = handler;
    watched |= 1u << pin;
    levels = at(kIn);
}
void detachInterrupt(pin_size_t pin) {
    watched &= ~(1u << pin);
}

static uint8_t tonePin;
static uint32_t toneHalf, toneLeft, toneAt;  // microseconds, halves, when

void tone(uint8_t pin, unsigned int hertz, unsigned long milliseconds) {
    pinMode(pin, OUTPUT);
    tonePin = pin;
    toneHalf = 500000 / hertz;
    toneLeft = static_cast<uint32_t>(hertz * milliseconds / 500);
    toneAt = micros();
}
void noTone(uint8_t pin) {
    toneLeft = 0;
    digitalWrite(pin, LOW);
}

void betweenLoops() {
    if (watched != 0) {
        const uint32_t changed = (levels ^ at(kIn)) & watched;
        levels ^= changed;
        for (pin_size_t pin = 0; pin < NUM_DIGITAL_PINS; ++pin)
            if (changed >> pin & 1) handlers[pin]();
    }
    if (toneLeft != 0 && micros() - toneAt >= toneHalf) {
        toneAt += toneHalf;
        --toneLeft;
        digitalWrite(tonePin, toneLeft % 2 != 0 ? HIGH : LOW);
    }
    waitMicroseconds(50);
}

ChipSerial Serial;

void ChipSerial::begin(unsigned long baud) {
    at(kDivisor) = 16000000 / static_cast<uint32_t>(baud) - 1;
    at(kSendControl) = 1;
    at(kReceiveControl) = 1;
    at(kFunction) = at(kFunction) | kUartPins;
}
int ChipSerial::read() {
    const uint32_t received = at(kReceive);
    return received & kNotNow ? -1 : static_cast<uint8_t>(received);
}
int ChipSerial::availableForWrite() {
    return ByteRing::kSize;
}
size_t ChipSerial::write(uint8_t byte) {
    while (at(kSend) & kNotNow) {
    }
    at(kSend) = byte;
    return 1;
}
void ChipSerial::flush() {}
