// SPDX-License-Identifier: Apache-2.0
// Temperature, humidity and air pressure (BME280 or BMP280) on the I2C bus: VIN to 5V, GND to GND, SDA to A4 and SCL to A5
// of an Uno.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipWeather.h>

asip::Weather weather;

void setup() {
    asip::board.add(weather);
    asip::board.begin(ASIP_NAME("AsipWeather"));
}

void loop() { asip::board.run(); }
