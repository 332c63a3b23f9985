// SPDX-License-Identifier: Apache-2.0
// A strip of 18 WS2812 pixels on pin 6.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipPixels.h>

asip::Pixels<18> pixels(6);

void setup() {
    asip::board.add(pixels);
    asip::board.begin(ASIP_NAME("AsipPixels"));
}

void loop() { asip::board.run(); }
