// SPDX-License-Identifier: Apache-2.0
// An Arduino core that is not there, of a chip that is not AVR: the functions that such cores share, over
// variables that a test sets and looks at (ArduinoFake).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

class __FlashStringHelper;
#define PROGMEM
#define F(text) (reinterpret_cast<const __FlashStringHelper*>(text))
#define pgm_read_byte(address) (*reinterpret_cast<const std::uint8_t*>(address))
#define pgm_read_word(address) (*reinterpret_cast<const std::uint16_t*>(address))

#define NUM_DIGITAL_PINS 22
#define NUM_ANALOG_INPUTS 4
constexpr std::uint8_t A0 = 18, A1 = 19, A2 = 20, A3 = 21;
#define digitalPinHasPWM(pin) ((pin) >= 4 && (pin) <= 7)
#define NOT_AN_INTERRUPT -1
#define digitalPinToInterrupt(pin) ((pin) < 16 ? (pin) : NOT_AN_INTERRUPT)

enum : std::uint8_t { LOW = 0, HIGH = 1 };
enum : std::uint8_t { INPUT = 0, OUTPUT = 1, INPUT_PULLUP = 2 };
enum : std::uint8_t { CHANGE = 1 };

void pinMode(std::uint8_t pin, std::uint8_t mode);
void digitalWrite(std::uint8_t pin, std::uint8_t level);
int digitalRead(std::uint8_t pin);
int analogRead(std::uint8_t pin);
void analogWrite(std::uint8_t pin, int duty);
unsigned long millis();
unsigned long micros();
void delayMicroseconds(unsigned microseconds);
void tone(std::uint8_t pin, unsigned hertz, unsigned long milliseconds);
void noTone(std::uint8_t pin);
void attachInterrupt(std::uint8_t interrupt, void (*handler)(), int mode);
void detachInterrupt(std::uint8_t interrupt);
void noInterrupts();
void interrupts();

class FakeSerial {
  public:
    void begin(unsigned long baud);
    int read();
    int availableForWrite();
    std::size_t write(std::uint8_t byte);
    void flush() {}
};
extern FakeSerial Serial;

struct ArduinoFake {
    bool levels[NUM_DIGITAL_PINS] = {};
    std::uint8_t modes[NUM_DIGITAL_PINS] = {};
    int duty[NUM_DIGITAL_PINS] = {};  // -1: no PWM
    int analog[NUM_ANALOG_INPUTS] = {};
    unsigned long microseconds = 0;
    unsigned tone_hertz = 0;
    void (*handlers[NUM_DIGITAL_PINS])() = {};
    int locks = 0;  // of interrupts
    unsigned long baud = 0;
    std::string to_board;
    std::string from_board;

    /// From outside; an attached interrupt runs.
    void drive(std::uint8_t pin, bool high);
};
extern ArduinoFake arduino;
