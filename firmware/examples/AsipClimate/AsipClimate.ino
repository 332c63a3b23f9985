// SPDX-License-Identifier: Apache-2.0
// Temperature and humidity by two DHT22 (AM2302) sensors: red wire to 5V, black to GND, data to pin 10 and to pin 11,
// each with a resistor of 10 kOhm from data to 5V where the sensor is no module that has it. For the blue DHT11 write
// kDht11.
#include <Asip.h>
#include <AsipDht.h>
#include <AsipFastSerial.h>

asip::Dht climate(asip::Dht::kDht22, 10, 11);

void setup() {
    asip::board.add(climate);
    asip::board.begin(ASIP_NAME("AsipClimate"));
}

void loop() { asip::board.run(); }
