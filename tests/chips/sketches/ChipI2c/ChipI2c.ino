// SPDX-License-Identifier: Apache-2.0
// Every service on the I2C bus, by the Wire of a core for a chip that is not AVR.
#include <Asip.h>
#include <AsipLcd.h>
#include <AsipMotion.h>
#include <AsipPressure.h>
#include <AsipSerial.h>

asip::Motion accelerometer(asip::Motion::kAccelerometer);
asip::Motion gyroscope(asip::Motion::kGyroscope);
asip::Motion heading(asip::Motion::kHeading);
asip::Pressure pressure;
asip::Lcd lcd;

void setup() {
    asip::board.add(accelerometer);
    asip::board.add(gyroscope);
    asip::board.add(heading);
    asip::board.add(pressure);
    asip::board.add(lcd);
    asip::board.begin(ASIP_NAME("ChipI2c"));
}

void loop() { asip::board.run(); }
