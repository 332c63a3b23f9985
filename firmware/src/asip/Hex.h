// SPDX-License-Identifier: Apache-2.0
// Bytes as text, two hexadecimal digits each.
#pragma once

#include "Out.h"

namespace asip {

void writeHex(const uint8_t* bytes, uint8_t count);

// The value of a digit, 255 if it is none.
uint8_t hexValue(char c) __attribute__((noinline));

// Reads `text` into `bytes`, of which there are `room`. False if it is no bytes, or more.
bool readHex(const char* text, uint8_t* bytes, uint8_t room, uint8_t& count);

}  // namespace asip
