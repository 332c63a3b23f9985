// SPDX-License-Identifier: Apache-2.0
// The 32 GPIOs of a FE310 (HiFive1): no converter, and no PWM is used.
#pragma once

#define NUM_DIGITAL_PINS 32
#define NUM_ANALOG_INPUTS 0
#define digitalPinToInterrupt(pin) (((pin) < NUM_DIGITAL_PINS) ? (pin) : NOT_AN_INTERRUPT)
