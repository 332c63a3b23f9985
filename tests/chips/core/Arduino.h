// SPDX-License-Identifier: Apache-2.0
// The functions that Arduino cores for 32-bit chips share, with the types that ArduinoCore-API gives them: a
// mode and a level are enumerations. Each chip has them in a folder beside this one, over its registers.
#pragma once

#include <stddef.h>
#include <stdint.h>

class __FlashStringHelper;
#define PROGMEM
#define PSTR(text) (text)
#define F(text) (reinterpret_cast<const __FlashStringHelper*>(PSTR(text)))
#define pgm_read_byte(address) (*reinterpret_cast<const uint8_t*>(address))
#define pgm_read_word(address) (*reinterpret_cast<const uint16_t*>(address))

typedef uint8_t pin_size_t;
typedef enum { LOW = 0, HIGH = 1, CHANGE = 2, FALLING = 3, RISING = 4 } PinStatus;
typedef enum { INPUT = 0, OUTPUT = 1, INPUT_PULLUP = 2, INPUT_PULLDOWN = 3 } PinMode;
#define NOT_AN_INTERRUPT (-1)

extern "C" {
void pinMode(pin_size_t pin, PinMode mode);
void digitalWrite(pin_size_t pin, PinStatus level);
PinStatus digitalRead(pin_size_t pin);
int analogRead(pin_size_t pin);
void analogWrite(pin_size_t pin, int duty);
unsigned long millis(void);
unsigned long micros(void);
void delayMicroseconds(unsigned int microseconds);
void attachInterrupt(pin_size_t interrupt, void (*handler)(void), PinStatus mode);
void detachInterrupt(pin_size_t interrupt);
void noInterrupts(void);
void interrupts(void);
void setup(void);
void loop(void);
}
void tone(uint8_t pin, unsigned int hertz, unsigned long milliseconds = 0);
void noTone(uint8_t pin);

// What sketches that have a number for a level call.
inline void digitalWrite(pin_size_t pin, int level) {
    digitalWrite(pin, level == 0 ? LOW : HIGH);
}

#include "ChipSerial.h"
#include "pins_arduino.h"
