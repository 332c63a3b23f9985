// SPDX-License-Identifier: Apache-2.0
// What the library cannot ask an Arduino core for, of the chips that are not AVR and known here. For another
// chip, or to have it otherwise, define before the library is compiled (build flags):
//
//   ASIP_CHIP "name"           what #,? says; no comma in it
//   ASIP_PINS 40               if pins are not numbered from 0 to NUM_DIGITAL_PINS - 1
//   ASIP_FIRST_ANALOG_PIN 32   the first of the pins with a converter, which have to be neighbours ...
//   ASIP_ANALOG_PINS 8         ... and how many these are
//   ASIP_ANALOG_BITS 12        if analogRead() gives more than 10 bits
//   ASIP_IS_HIDDEN_PIN(pin)    true for pins that nothing may touch
//   ASIP_HAS_PWM(pin)          true for pins that analogWrite() works on
//   ASIP_HAS_EEPROM 0          a name given by #,I is not kept
//   ASIP_EEPROM_SIZE 512       bytes of the core's EEPROM; the name has the last 34
#pragma once

#if defined(ESP8266)
// The flash is at 6 to 11. A0 is 17, behind the pins that the core counts.
#ifndef ASIP_CHIP
#define ASIP_CHIP "ESP8266"
#endif
#ifndef ASIP_IS_HIDDEN_PIN
#define ASIP_IS_HIDDEN_PIN(pin) ((pin) >= 6 && (pin) <= 11)
#endif

#elif defined(CONFIG_IDF_TARGET_ESP32)
// The flash is at 6 to 11; 20, 24 and 28 to 31 do not exist; from 34 on there are inputs only. The converter
// of 32 to 39 works beside the network, that of the other pins does not.
#ifndef ASIP_CHIP
#define ASIP_CHIP "ESP32"
#endif
#ifndef ASIP_PINS
#define ASIP_PINS 40
#endif
#ifndef ASIP_IS_HIDDEN_PIN
#define ASIP_IS_HIDDEN_PIN(pin) \
    (((pin) >= 6 && (pin) <= 11) || (pin) == 20 || (pin) == 24 || ((pin) >= 28 && (pin) <= 31))
#endif
#ifndef ASIP_HAS_PWM
#define ASIP_HAS_PWM(pin) ((pin) < 34)
#endif
#ifndef ASIP_FIRST_ANALOG_PIN
#define ASIP_FIRST_ANALOG_PIN 32
#define ASIP_ANALOG_PINS 8
#endif

#elif defined(CONFIG_IDF_TARGET_ESP32C3)
// The flash is at 11 to 17, USB at 18 and 19.
#ifndef ASIP_CHIP
#define ASIP_CHIP "ESP32-C3"
#endif
#ifndef ASIP_PINS
#define ASIP_PINS 22
#endif
#ifndef ASIP_IS_HIDDEN_PIN
#define ASIP_IS_HIDDEN_PIN(pin) ((pin) >= 11 && (pin) <= 19)
#endif
#ifndef ASIP_HAS_PWM
#define ASIP_HAS_PWM(pin) true
#endif
#ifndef ASIP_FIRST_ANALOG_PIN
#define ASIP_FIRST_ANALOG_PIN 0
#define ASIP_ANALOG_PINS 5
#endif

#elif defined(ESP32)
#if !defined(ASIP_PINS) || !defined(ASIP_IS_HIDDEN_PIN) || !defined(ASIP_FIRST_ANALOG_PIN)
#error "Asip does not know the pins of this ESP32: define what HardwareChips.h lists (ASIP_PINS, ...)"
#endif

#elif defined(ARDUINO_ARCH_RP2040)
#ifndef ASIP_CHIP
#ifdef PICO_RP2350
#define ASIP_CHIP "RP2350"
#else
#define ASIP_CHIP "RP2040"
#endif
#endif
#endif

#ifndef ASIP_CHIP
#ifdef ARDUINO_BOARD
#define ASIP_CHIP ARDUINO_BOARD
#else
#define ASIP_CHIP "Arduino"
#endif
#endif
#ifndef ASIP_PINS
#define ASIP_PINS NUM_DIGITAL_PINS
#endif
#ifndef ASIP_FIRST_ANALOG_PIN
#define ASIP_FIRST_ANALOG_PIN A0
#define ASIP_ANALOG_PINS NUM_ANALOG_INPUTS
#endif
#ifndef ASIP_IS_HIDDEN_PIN
#define ASIP_IS_HIDDEN_PIN(pin) ((void)(pin), false)
#endif
#ifndef ASIP_HAS_PWM
#ifdef digitalPinHasPWM
#define ASIP_HAS_PWM(pin) digitalPinHasPWM(pin)
#else
#define ASIP_HAS_PWM(pin) ((void)(pin), false)
#endif
#endif
#ifndef ASIP_ANALOG_BITS
#ifdef ESP32
#define ASIP_ANALOG_BITS 12
#else
#define ASIP_ANALOG_BITS 10
#endif
#endif

// These cores keep an EEPROM in their flash; Arduino's own core for the RP2040 (of mbed) has none.
#ifndef ASIP_HAS_EEPROM
#if defined(ESP8266) || defined(ESP32) || (defined(ARDUINO_ARCH_RP2040) && !defined(ARDUINO_ARCH_MBED))
#define ASIP_HAS_EEPROM 1
#else
#define ASIP_HAS_EEPROM 0
#endif
#endif
#ifndef ASIP_EEPROM_SIZE
#define ASIP_EEPROM_SIZE 512
#endif
#if ASIP_HAS_EEPROM
#include <EEPROM.h>
#endif
