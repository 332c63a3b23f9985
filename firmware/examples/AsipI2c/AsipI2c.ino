// SPDX-License-Identifier: Apache-2.0
// Any chips on the I2C bus (A4 and A5 of an Uno), which programs reach by the drivers that they have for them.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipI2cChips.h>

asip::I2cChips chips;

void setup() {
    asip::board.add(chips);
    asip::board.begin(ASIP_NAME("AsipI2c"));
}

void loop() { asip::board.run(); }
