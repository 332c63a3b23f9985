// SPDX-License-Identifier: Apache-2.0
// The serial line under the protocol. These functions are defined by whichever of <AsipFastSerial.h> and
// <AsipSerial.h> the sketch includes (exactly one, in one file), and by a fake in the tests: chosen when
// linking, a line costs no RAM and no indirect call.
#pragma once

#include <stdint.h>

namespace asip {
namespace line {

// Opens the line at kDefaultRate.
void begin();

// Next byte received, or -1. A byte that arrived damaged, or in whose place bytes were lost, reads as 0.
int16_t read();

// Bytes that write() takes now without waiting.
uint8_t room();

// Queues one byte; waits while the queue is full.
void write(uint8_t byte);

// True when all that was written has left the wire (or may be taken to have, for a line that cannot tell).
bool idle();

// Switches to `hundreds` of baud, one of the rates that isRate() allows, and drops what was received before
// and not read. Call when idle.
void setRate(uint16_t hundreds);

// True if the line can run at `hundreds` of baud with an error below 2.5 %.
bool canMakeRate(uint16_t hundreds);

// True if the board may step up to it. The line says the same as canMakeRate(); a service whose interrupts
// leave it no time for the fastest (Encoders, on AVR) defines another one, which the linker prefers.
bool isRate(uint16_t hundreds);
#ifdef __AVR__
#define ASIP_RATE_UNLESS_TOLD __attribute__((weak))
#else
#define ASIP_RATE_UNLESS_TOLD
#endif

// True for the pins that the line itself occupies.
bool usesPin(uint8_t pin);

}  // namespace line
}  // namespace asip
