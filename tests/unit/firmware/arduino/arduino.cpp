// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "Arduino.h"

ArduinoFake arduino;
FakeSerial Serial;

// What does not exist must not be asked for.
static std::uint8_t existing(std::uint8_t pin) {
    if (pin >= NUM_DIGITAL_PINS) std::abort();
    return pin;
}

void ArduinoFake::drive(std::uint8_t pin, bool high) {
    if (levels[existing(pin)] == high) return;
    levels[pin] = high;
    if (handlers[pin] != nullptr) handlers[pin]();
}

void pinMode(std::uint8_t pin, std::uint8_t mode) {
    arduino.modes[existing(pin)] = mode;
    if (mode == INPUT_PULLUP) arduino.levels[pin] = true;
}
void digitalWrite(std::uint8_t pin, std::uint8_t level) {
    arduino.duty[existing(pin)] = -1;
    if (arduino.modes[pin] == OUTPUT) arduino.levels[pin] = level != LOW;
}
int digitalRead(std::uint8_t pin) {
    return arduino.levels[existing(pin)] ? HIGH : LOW;
}
int analogRead(std::uint8_t pin) {
    if (pin < A0 || pin > A3) std::abort();
    return arduino.analog[pin - A0];
}
void analogWrite(std::uint8_t pin, int duty) {
    arduino.duty[existing(pin)] = duty;
}
unsigned long millis() {
    return arduino.microseconds / 1000;
}
unsigned long micros() {
    return arduino.microseconds;
}
void delayMicroseconds(unsigned microseconds) {
    arduino.microseconds += microseconds;
}
void tone(std::uint8_t pin, unsigned hertz, unsigned long) {
    existing(pin);
    arduino.tone_hertz = hertz;
}
void noTone(std::uint8_t pin) {
    existing(pin);
    arduino.tone_hertz = 0;
}
void attachInterrupt(std::uint8_t interrupt, void (*handler)(), int) {
    arduino.handlers[existing(interrupt)] = handler;
}
void detachInterrupt(std::uint8_t interrupt) {
    arduino.handlers[existing(interrupt)] = nullptr;
}
void noInterrupts() {
    ++arduino.locks;
}
void interrupts() {
    if (--arduino.locks < 0) std::abort();
}

void FakeSerial::begin(unsigned long baud) {
    arduino.baud = baud;
}
int FakeSerial::read() {
    if (arduino.to_board.empty()) return -1;
    const auto byte = static_cast<std::uint8_t>(arduino.to_board.front());
    arduino.to_board.erase(0, 1);
    return byte;
}
int FakeSerial::availableForWrite() {
    return 63;
}
std::size_t FakeSerial::write(std::uint8_t byte) {
    arduino.from_board.push_back(static_cast<char>(byte));
    return 1;
}
