// SPDX-License-Identifier: Apache-2.0
// The Arduino core's functions on the RP2040: pins, converter, PWM, time, interrupts of pins, tones.
#include <Arduino.h>

#include "core/runtime.h"
#include "registers.h"

using namespace rp2040;

static constexpr uint32_t kIn = kSio + 0x04, kOutSet = kSio + 0x14, kOutClear = kSio + 0x18,
                          kOutToggle = kSio + 0x1c;
static constexpr uint32_t kEnableSet = kSio + 0x24, kEnableClear = kSio + 0x28;
static constexpr uint32_t kAlarm0 = kTimer + 0x10, kAlarm1 = kTimer + 0x14, kArmed = kTimer + 0x20;
static constexpr uint32_t kNow = kTimer + 0x28, kTimerRaw = kTimer + 0x34, kTimerEnable = kTimer + 0x38;
static constexpr uint32_t kMillisecond = 1000;

static volatile uint32_t milliseconds;
static void (*handlers[NUM_DIGITAL_PINS])();

// A tone: the pin is turned over at each half of its wave.
static uint8_t tonePin;
static uint32_t toneHalf;           // microseconds
static volatile uint32_t toneLeft;  // halves; 0: silent
static constexpr uint32_t kForEver = ~0u;

static uint32_t bit(uint8_t pin) {
    return 1u << pin;
}

void rp2040::beginPins() {
    for (uint8_t pin = 0; pin < NUM_DIGITAL_PINS; ++pin)
        at(control(pin)) = kFunctionSio;
    at(kTimerEnable) = 3;
    at(kAlarm0) = at(kNow) + kMillisecond;
    enableInterrupt(kTimerIrq0);
    enableInterrupt(kTimerIrq1);
    enableInterrupt(kIoIrq);
    at(kAdc) = 1;  // on
}

void pinMode(pin_size_t pin, PinMode mode) {
    at(control(pin)) = kFunctionSio;
    at(pad(pin)) = kInputEnable | 1u << 4 | (mode == INPUT_PULLUP ? kPullUp : 0) |
                   (mode == INPUT_PULLDOWN ? kPullDown : 0);
    at(mode == OUTPUT ? kEnableSet : kEnableClear) = bit(pin);
}

void digitalWrite(pin_size_t pin, PinStatus level) {
    at(level == LOW ? kOutClear : kOutSet) = bit(pin);
    at(control(pin)) = kFunctionSio;
}

PinStatus digitalRead(pin_size_t pin) {
    return at(kIn) & bit(pin) ? HIGH : LOW;
}

// All twelve bits.
int analogRead(pin_size_t pin) {
    constexpr uint32_t kReady = 1u << 8, kStart = 1u << 2, kOn = 1;
    at(pad(pin)) = kOutputDisable;  // neither a digital input nor a pull
    at(kAdc) = static_cast<uint32_t>(pin - A0) << 12 | kStart | kOn;
    while ((at(kAdc) & kReady) == 0) {
    }
    return static_cast<int>(at(kAdc + 4) & 0xfff);
}

// A kilohertz; 255 is always on.
void analogWrite(pin_size_t pin, int duty) {
    const uint32_t slice = kPwm + 0x14 * (pin / 2 % 8);
    const uint32_t shift = pin % 2 * 16;
    at(slice + 0x04) = (kCrystalHertz / 255 / 1000) << 4;  // divider
    at(slice + 0x10) = 254;                                // where it begins again
    at(slice + 0x0c) = (at(slice + 0x0c) & ~(0xffffu << shift)) | static_cast<uint32_t>(duty) << shift;
    at(slice) = 1;
    at(pad(pin)) = kInputEnable | 1u << 4;
    at(control(pin)) = kFunctionPwm;
}

unsigned long micros() {
    return at(kNow);
}
unsigned long millis() {
    return milliseconds;
}
void delayMicroseconds(unsigned int microseconds) {
    const uint32_t since = at(kNow);
    while (at(kNow) - since < microseconds) {
    }
}

void betweenLoops() {}

void noInterrupts() {
    asm volatile("cpsid i" ::: "memory");
}
void interrupts() {
    asm volatile("cpsie i" ::: "memory");
}

void rp2040::onTimer0() {
    at(kTimerRaw) = 1;
    // Several at once where the interrupts were off: a moment that is over would come again after an hour.
    uint32_t next = at(kAlarm0);
    do {
        milliseconds = milliseconds + 1;
        next += kMillisecond;
    } while (static_cast<int32_t>(next - at(kNow)) < 10);
    at(kAlarm0) = next;
}

// Four bits for each pin: level low and high, edge down and up.
static void setEdges(uint8_t pin, uint32_t edges) {
    const uint32_t address = kIoBank + 0x100 + 4u * (pin / 8);
    const uint32_t shift = pin % 8 * 4;
    at(kIoBank + 0xf0 + 4u * (pin / 8)) = 0xcu << shift;  // what happened before
    clearBits(address, 0xfu << shift);
    setBits(address, edges << shift);
}

void attachInterrupt(pin_size_t pin, void (*handler)(), PinStatus mode) {
    handlers[pin] = handler;
    setEdges(pin, mode == FALLING ? 4 : mode == RISING ? 8 : 12);
}
void detachInterrupt(pin_size_t pin) {
    setEdges(pin, 0);
    handlers[pin] = nullptr;
}

void rp2040::onPins() {
    for (uint8_t group = 0; group < 4; ++group) {
        uint32_t events = at(kIoBank + 0x120 + 4u * group);
        at(kIoBank + 0xf0 + 4u * group) = events;
        for (uint8_t pin = static_cast<uint8_t>(8 * group); events != 0; ++pin, events >>= 4)
            if ((events & 0xf) != 0 && handlers[pin] != nullptr) handlers[pin]();
    }
}

void tone(uint8_t pin, unsigned int hertz, unsigned long duration) {
    noTone(pin);
    pinMode(pin, OUTPUT);
    tonePin = pin;
    toneHalf = 500000 / hertz;
    toneLeft = duration == 0 ? kForEver : static_cast<uint32_t>(hertz * duration / 500) + 1;
    at(kAlarm1) = at(kNow) + toneHalf;
}
void noTone(uint8_t pin) {
    at(kArmed) = 2;
    toneLeft = 0;
    at(kTimerRaw) = 2;
    digitalWrite(pin, LOW);
}

void rp2040::onTimer1() {
    at(kTimerRaw) = 2;
    if (toneLeft == 0) return;
    if (toneLeft != kForEver) toneLeft = toneLeft - 1;
    if (toneLeft == 0) return digitalWrite(tonePin, LOW);
    at(kOutToggle) = bit(tonePin);
    const uint32_t next = at(kAlarm1) + toneHalf;
    at(kAlarm1) = static_cast<int32_t>(next - at(kNow)) < 10 ? at(kNow) + 10 : next;
}
