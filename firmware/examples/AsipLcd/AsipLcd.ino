// SPDX-License-Identifier: Apache-2.0
// A display with an SH1106 on the I2C bus.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipLcd.h>

asip::Lcd lcd;

void setup() {
    asip::board.add(lcd);
    asip::board.begin(ASIP_NAME("AsipLcd"));
}

void loop() { asip::board.run(); }
