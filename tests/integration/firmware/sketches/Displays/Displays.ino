// SPDX-License-Identifier: Apache-2.0
// Everything on the I2C bus, and a strip of 18 pixels: what the sizes are measured with. Pixels and Pressure have the
// same letter: the one that is added first gets the requests.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipLcd.h>
#include <AsipMotion.h>
#include <AsipPixels.h>
#include <AsipPressure.h>

asip::Lcd lcd;
asip::Pixels<18> pixels(6);
asip::Motion accelerometer(asip::Motion::kAccelerometer);
asip::Motion gyroscope(asip::Motion::kGyroscope);
asip::Motion heading(asip::Motion::kHeading);
asip::Pressure pressure;

void setup() {
    asip::board.add(lcd);
    asip::board.add(pixels);
    asip::board.add(accelerometer);
    asip::board.add(gyroscope);
    asip::board.add(heading);
    asip::board.add(pressure);
    asip::board.begin(ASIP_NAME("Displays"));
}

void loop() { asip::board.run(); }
