// SPDX-License-Identifier: Apache-2.0
// A board with the input/output service alone: its pins, analog inputs and PWM, over the serial line.
#include <Asip.h>
#include <AsipFastSerial.h>

void setup() { asip::board.begin(ASIP_NAME("AsipHello")); }

void loop() { asip::board.run(); }
