// SPDX-License-Identifier: Apache-2.0
// The line on the Arduino core's own Serial: for sketches that use Serial themselves, and for boards whose
// Serial is a USB port of the chip (Leonardo).
#include <Asip.h>
#include <AsipSerial.h>

void setup() { asip::board.begin(ASIP_NAME("AsipPlainSerial")); }

void loop() { asip::board.run(); }
