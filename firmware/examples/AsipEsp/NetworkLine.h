// SPDX-License-Identifier: Apache-2.0
// Carries the line of the board over the network, in place of a serial port: what comes from a TCP client or
// from the bus is read by the board, and each line that the board writes goes to all that listen. Include it
// in one file.
#pragma once

#include <Arduino.h>
#include <Asip.h>

namespace networkLine {

// Where a complete line goes: `length` characters and a line end behind them. Set before the board begins.
typedef void (*LineSink)(const char* line, uint16_t length);
extern LineSink sink;

// Gives the board bytes to read. False, and nothing given, if there is no room for all of them.
bool give(const uint8_t* bytes, uint16_t length);

// The lines of a message, whose last has no end: give() adds it.
bool giveLines(const uint8_t* text, uint16_t length);

}  // namespace networkLine
