// SPDX-License-Identifier: Apache-2.0
// The Arduino core of the ESP8266: texts of F() are in flash, which is read by words only; interrupts() is a
// macro; functions that an interrupt calls are in RAM.
#pragma once

#include "../common.h"

#define INPUT 0x00
#define INPUT_PULLUP 0x02
#define INPUT_PULLDOWN_16 0x04
#define OUTPUT 0x01
#define OUTPUT_OPEN_DRAIN 0x03
#define SPECIAL 0xF8
#define PWMRANGE 1023
#define abs(x) ((x) > 0 ? (x) : -(x))
#define round(x) ((x) >= 0 ? (long)((x) + 0.5) : (long)((x) - 0.5))
typedef uint16_t word;

#define ASIP_TEXT_OF(x) #x
#define ASIP_TEXT(x) ASIP_TEXT_OF(x)
#define PROGMEM __attribute__((section(".irom.text." ASIP_TEXT(__LINE__) "." ASIP_TEXT(__COUNTER__))))
#define PSTR(text)                                                                                        \
    (__extension__({                                                                                      \
        static const char inFlash[] __attribute__((aligned(4)))                                           \
        __attribute__((section(".irom0.pstr." ASIP_TEXT(__LINE__) "." ASIP_TEXT(__COUNTER__)))) = (text); \
        &inFlash[0];                                                                                      \
    }))
class __FlashStringHelper;
#define F(text) (reinterpret_cast<const __FlashStringHelper*>(PSTR(text)))
static inline uint8_t readFlashByte(const void* address) {
    const uint32_t at = reinterpret_cast<uint32_t>(address);
    return static_cast<uint8_t>(*reinterpret_cast<const volatile uint32_t*>(at & ~3u) >> (at % 4 * 8));
}
static inline uint16_t readFlashWord(const void* address) {
    return static_cast<uint16_t>(readFlashByte(address) | readFlashByte(static_cast<const char*>(address) + 1)
                                                              << 8);
}
#define pgm_read_byte(address) readFlashByte(address)
#define pgm_read_word(address) readFlashWord(address)
#define IRAM_ATTR __attribute__((section(".iram.text")))

extern "C" {
int analogRead(uint8_t pin);
void analogWrite(uint8_t pin, int value);
void delayMicroseconds(unsigned int microseconds);
void attachInterrupt(uint8_t pin, void (*handler)(void), int mode);
void detachInterrupt(uint8_t pin);
}

#define xt_rsil(level)                                                                \
    (__extension__({                                                                  \
        uint32_t state;                                                               \
        __asm__ __volatile__("rsil %0," ASIP_TEXT(level) : "=a"(state) : : "memory"); \
        state;                                                                        \
    }))
#define interrupts() xt_rsil(0)
#define noInterrupts() xt_rsil(15)

#define digitalPinToPort(pin) (((pin) == 16) ? (1) : (0))
#define digitalPinToBitMask(pin) (((pin) == 16) ? (1) : (1UL << (pin)))
#define digitalPinToTimer(pin) (0)

#define EXTERNAL_NUM_INTERRUPTS 16
#define NUM_DIGITAL_PINS 17
#define NUM_ANALOG_INPUTS 1
#define isFlashInterfacePin(p) ((p) >= 6 && (p) <= 11)
#define digitalPinToInterrupt(p) (((p) < EXTERNAL_NUM_INTERRUPTS) ? (p) : NOT_AN_INTERRUPT)
#define digitalPinHasPWM(p) (((p) < NUM_DIGITAL_PINS && !isFlashInterfacePin(p)) ? 1 : 0)
#define PIN_A0 (17)
static const uint8_t A0 = PIN_A0;
static const uint8_t TX = 1;
static const uint8_t RX = 3;
static const uint8_t SDA = 4;
static const uint8_t SCL = 5;

#define ASIP_STOPPED bool
#define ASIP_BEGUN void
