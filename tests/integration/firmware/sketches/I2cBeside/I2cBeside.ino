// SPDX-License-Identifier: Apache-2.0
// For tests: any chip on the I2C bus, beside services that have chips of their own there.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipI2cChips.h>
#include <AsipLcd.h>
#include <AsipMotion.h>

asip::Motion accelerometer(asip::Motion::kAccelerometer);
asip::I2cChips chips;
asip::Motion heading(asip::Motion::kHeading);
asip::Lcd lcd;

void setup() {
    asip::board.add(accelerometer);
    asip::board.add(chips);
    asip::board.add(heading);
    asip::board.add(lcd);
    asip::board.begin(ASIP_NAME("I2cBeside"));
}

void loop() { asip::board.run(); }
