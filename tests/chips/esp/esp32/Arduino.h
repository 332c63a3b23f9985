// SPDX-License-Identifier: Apache-2.0
// The Arduino core of the ESP32 and the ESP32-C3: flash is read as memory; interrupts() is a macro; functions
// that an interrupt calls are in RAM; the converters, of 12 bits, are no neighbours in the order of A0, A1,
// ...
#pragma once

#include "../common.h"

#define INPUT 0x01
#define OUTPUT 0x03
#define PULLUP 0x04
#define INPUT_PULLUP 0x05
#define INPUT_PULLDOWN 0x09
#define OPEN_DRAIN 0x10
#define OUTPUT_OPEN_DRAIN 0x13
#define ANALOG 0xC0
typedef unsigned int word;

#define PROGMEM
#define PSTR(text) (text)
class __FlashStringHelper;
#define F(text) (reinterpret_cast<const __FlashStringHelper*>(PSTR(text)))
#define pgm_read_byte(address) (*(const unsigned char*)(address))
#define pgm_read_word(address)                   \
    ({                                           \
        decltype(address + 0) where = (address); \
        *(const unsigned short*)(where);         \
    })
#define IRAM_ATTR __attribute__((section(".iram1")))

extern "C" {
uint16_t analogRead(uint8_t pin);
void delayMicroseconds(uint32_t microseconds);
void attachInterrupt(uint8_t pin, void (*handler)(void), int mode);
void detachInterrupt(uint8_t pin);
void disableInterruptsOfThisCore(void);
void enableInterruptsOfThisCore(void);
}
void analogWrite(uint8_t pin, int value);
#define sei() enableInterruptsOfThisCore()
#define cli() disableInterruptsOfThisCore()
#define interrupts() sei()
#define noInterrupts() cli()

#define digitalPinToTimer(pin) (0)
#define analogInPinToBit(P) (P)

#ifdef CONFIG_IDF_TARGET_ESP32
#define NUM_DIGITAL_PINS 40
#define NUM_ANALOG_INPUTS 16
#define digitalPinToInterrupt(p) (((p) < 40) ? (p) : -1)
#define digitalPinHasPWM(p) (p < 34)
static const uint8_t TX = 1;
static const uint8_t RX = 3;
static const uint8_t SDA = 21;
static const uint8_t SCL = 22;
static const uint8_t A0 = 36;
static const uint8_t A3 = 39;
static const uint8_t A4 = 32;
static const uint8_t A5 = 33;
#else
#define NUM_DIGITAL_PINS 22
#define NUM_ANALOG_INPUTS 6
#define digitalPinToInterrupt(p) (((p) < NUM_DIGITAL_PINS) ? (p) : -1)
#define digitalPinHasPWM(p) (p < NUM_DIGITAL_PINS)
static const uint8_t TX = 21;
static const uint8_t RX = 20;
static const uint8_t SDA = 8;
static const uint8_t SCL = 9;
static const uint8_t A0 = 0;
static const uint8_t A5 = 5;
#endif

#define ASIP_STOPPED void
#define ASIP_BEGUN bool
