// SPDX-License-Identifier: Apache-2.0
// Pins of an ATmega644P or 1284P board in the numbering that the cores for these chips call standard: port B,
// D, C, A, eight pins each; A0 to A7 are pins 24 to 31.
#pragma once

#include <avr/pgmspace.h>
#include <stdint.h>

#define NUM_DIGITAL_PINS 32
#define NUM_ANALOG_INPUTS 8
#define analogInputToDigitalPin(channel) ((channel) < 8 ? (channel) + 24 : -1)

static const uint8_t SS = 4, MOSI = 5, MISO = 6, SCK = 7, SCL = 16, SDA = 17, LED_BUILTIN = 0;
static const uint8_t A0 = 24, A1 = 25, A2 = 26, A3 = 27, A4 = 28, A5 = 29, A6 = 30, A7 = 31;

#define digitalPinHasPWM(pin) \
    ((pin) == 3 || (pin) == 4 || (pin) == 6 || (pin) == 7 || ((pin) >= 12 && (pin) <= 15))
#define digitalPinToInterrupt(pin) ((pin) == 10 ? 0 : (pin) == 11 ? 1 : (pin) == 2 ? 2 : NOT_AN_INTERRUPT)

#define digitalPinToPCICR(pin) ((pin) >= 0 && (pin) < 32 ? &PCICR : (uint8_t*)0)
#define digitalPinToPCICRbit(pin) ((pin) < 8 ? 1 : (pin) < 16 ? 3 : (pin) < 24 ? 2 : 0)
#define digitalPinToPCMSK(pin) \
    ((pin) < 8 ? &PCMSK1 : (pin) < 16 ? &PCMSK3 : (pin) < 24 ? &PCMSK2 : (pin) < 32 ? &PCMSK0 : (uint8_t*)0)
#define digitalPinToPCMSKbit(pin) ((pin) & 7)

#ifdef ARDUINO_MAIN
#define EIGHT(item) item, item, item, item, item, item, item, item
#define BITS 1, 2, 4, 8, 16, 32, 64, 128

#ifdef TCCR3A  // a 644P has no timer 3
#define MIGHTY_TIMER3A TIMER3A
#define MIGHTY_TIMER3B TIMER3B
#else
#define MIGHTY_TIMER3A NOT_ON_TIMER
#define MIGHTY_TIMER3B NOT_ON_TIMER
#endif

// In the order of the port numbers PA, PB, PC, PD.
const uint16_t PROGMEM port_to_mode_PGM[] = {0, (uint16_t)&DDRA, (uint16_t)&DDRB, (uint16_t)&DDRC,
                                             (uint16_t)&DDRD};
const uint16_t PROGMEM port_to_output_PGM[] = {0, (uint16_t)&PORTA, (uint16_t)&PORTB, (uint16_t)&PORTC,
                                               (uint16_t)&PORTD};
const uint16_t PROGMEM port_to_input_PGM[] = {0, (uint16_t)&PINA, (uint16_t)&PINB, (uint16_t)&PINC,
                                              (uint16_t)&PIND};
const uint8_t PROGMEM digital_pin_to_port_PGM[] = {EIGHT(PB), EIGHT(PD), EIGHT(PC), EIGHT(PA)};
const uint8_t PROGMEM digital_pin_to_bit_mask_PGM[] = {BITS, BITS, BITS, BITS};
const uint8_t PROGMEM digital_pin_to_timer_PGM[] = {NOT_ON_TIMER,
                                                    NOT_ON_TIMER,
                                                    NOT_ON_TIMER,
                                                    TIMER0A,
                                                    TIMER0B,
                                                    NOT_ON_TIMER,
                                                    MIGHTY_TIMER3A,
                                                    MIGHTY_TIMER3B,
                                                    NOT_ON_TIMER,
                                                    NOT_ON_TIMER,
                                                    NOT_ON_TIMER,
                                                    NOT_ON_TIMER,
                                                    TIMER1B,
                                                    TIMER1A,
                                                    TIMER2B,
                                                    TIMER2A,
                                                    EIGHT(NOT_ON_TIMER),
                                                    EIGHT(NOT_ON_TIMER)};
#undef MIGHTY_TIMER3A
#undef MIGHTY_TIMER3B
#undef EIGHT
#undef BITS
#endif
