// SPDX-License-Identifier: Apache-2.0
#include "EchoTimer.h"

#ifdef ARDUINO
#include <Arduino.h>

#include "asip/PinInterrupts.h"

namespace asip {

static constexpr uint16_t kTimeoutMicroseconds = 25000;  // 4 m there and back, and a margin

enum Phase : uint8_t { kStopped, kWaitForQuiet, kBeforeEcho, kInEcho, kEchoOver };
static volatile uint8_t phase;
static volatile uint16_t since, length;  // microseconds
static uint8_t echoPin;
#ifdef __AVR__
static uint8_t echoPort, echoMask;
#endif

static uint16_t ASIP_FROM_INTERRUPT now() {
    return static_cast<uint16_t>(micros());
}
static bool ASIP_FROM_INTERRUPT isHigh() {
#ifdef __AVR__
    return *portInputRegister(echoPort) & echoMask;
#else
    return digitalRead(echoPin) == HIGH;
#endif
}

static void trigger() {
    pinMode(echoPin, OUTPUT);
    digitalWrite(echoPin, HIGH);
    delayMicroseconds(10);
    digitalWrite(echoPin, LOW);
    pinMode(echoPin, INPUT);
    since = now();
    phase = kBeforeEcho;
    PinInterrupts::enable(echoPin, PinInterrupts::kEcho, EchoTimer::onPinChange);
}

void EchoTimer::start(uint8_t pin) {
    echoPin = pin;
#ifdef __AVR__
    echoPort = digitalPinToPort(pin);
    echoMask = digitalPinToBitMask(pin);
#endif
    since = now();
    phase = kWaitForQuiet;
}

void EchoTimer::stop() {
    if (phase != kStopped) PinInterrupts::disable(echoPin);
    phase = kStopped;
}

bool EchoTimer::finished(uint16_t& microseconds) {
    // A sensor without an echo holds its echo for longer than we listen: its next turn waits for the end.
    if (phase == kWaitForQuiet && !isHigh()) trigger();
    noInterrupts();
    onPinChange();
    const bool over = phase == kEchoOver;
    const uint16_t waited = now() - since;
    interrupts();
    if (!over && waited <= kTimeoutMicroseconds) return false;
    stop();
    microseconds = over ? length : 0;
    return true;
}

// Encoders call it at each of their edges too: it must not take long where there is no echo to wait for.
void ASIP_FROM_INTERRUPT EchoTimer::onPinChange() {
    const uint8_t before = phase;
    if (before != kBeforeEcho && before != kInEcho) return;
    if (isHigh() == (before == kInEcho)) return;
    const uint16_t time = now();
    if (before == kBeforeEcho) {
        since = time;
        phase = kInEcho;
    } else {
        length = time - since;
        phase = kEchoOver;
    }
}

}  // namespace asip

#endif
