// SPDX-License-Identifier: Apache-2.0
// Accelerometer, gyroscope, compass and pressure sensor on the I2C bus: an MPU-6050, an HMC5883L and a BMP085, as on
// the usual boards with ten degrees of freedom.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipMotion.h>
#include <AsipPressure.h>

asip::Motion accelerometer(asip::Motion::kAccelerometer);
asip::Motion gyroscope(asip::Motion::kGyroscope);
asip::Motion heading(asip::Motion::kHeading);
asip::Pressure pressure;

void setup() {
    asip::board.add(accelerometer);
    asip::board.add(gyroscope);
    asip::board.add(heading);
    asip::board.add(pressure);
    asip::board.begin(ASIP_NAME("AsipImu"));
}

void loop() { asip::board.run(); }
