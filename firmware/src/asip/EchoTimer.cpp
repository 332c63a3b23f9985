#include "EchoTimer.h"

#ifdef ARDUINO
#include <Arduino.h>

#include "PinInterrupts.h"

namespace asip {

static constexpr uint16_t kTimeoutMicroseconds = 25000;  // 4 m there and back, and a margin

enum Phase : uint8_t { kStopped, kWaitForQuiet, kBeforeEcho, kInEcho, kEchoOver };
static volatile uint8_t phase;
static volatile uint16_t since, length;  // microseconds
static uint8_t echoPin, echoPort, echoMask;

static uint16_t now() {
    return static_cast<uint16_t>(micros());
}
static bool isHigh() {
    return *portInputRegister(echoPort) & echoMask;
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
    echoPort = digitalPinToPort(pin);
    echoMask = digitalPinToBitMask(pin);
    since = now();
    phase = kWaitForQuiet;
}

void EchoTimer::stop() {
    if (phase != kStopped) PinInterrupts::disable(echoPin);
    phase = kStopped;
}

bool EchoTimer::finished(uint16_t& microseconds) {
    // A sensor that heard nothing holds its echo for longer than we listen: its next turn waits for the end.
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

void EchoTimer::onPinChange() {
    const bool high = isHigh();
    if (phase == kBeforeEcho && high) {
        since = now();
        phase = kInEcho;
    } else if (phase == kInEcho && !high) {
        length = now() - since;
        phase = kEchoOver;
    }
}

}  // namespace asip

#endif
