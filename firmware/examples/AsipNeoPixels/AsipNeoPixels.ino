// SPDX-License-Identifier: Apache-2.0
// Two strips of 8 WS2812 pixels, on pins 5 and 6, as boards of python-asip have them.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipNeoPixels.h>

asip::PixelStripOf<8> left(5), right(6);
asip::NeoPixels neopixels(left, right);

void setup() {
    asip::board.add(neopixels);
    asip::board.begin(ASIP_NAME("AsipNeoPixels"));
}

void loop() { asip::board.run(); }
