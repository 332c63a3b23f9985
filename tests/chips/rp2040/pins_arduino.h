// SPDX-License-Identifier: Apache-2.0
// The pins of a Raspberry Pi Pico: the numbers of the chip, A0 to A3 are 26 to 29, each has PWM and an
// interrupt.
#pragma once

#define NUM_DIGITAL_PINS (30u)
#define NUM_ANALOG_INPUTS (4u)
#define LED_BUILTIN 25
#define digitalPinHasPWM(pin) ((pin) < NUM_DIGITAL_PINS)
#define digitalPinToInterrupt(pin) (((pin) < NUM_DIGITAL_PINS) ? (pin) : NOT_AN_INTERRUPT)

static const uint8_t SDA = (4u);
static const uint8_t SCL = (5u);
static const uint8_t A0 = (26u);
static const uint8_t A1 = (27u);
static const uint8_t A2 = (28u);
static const uint8_t A3 = (29u);
