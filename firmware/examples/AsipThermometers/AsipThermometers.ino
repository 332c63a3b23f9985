// SPDX-License-Identifier: Apache-2.0
// Thermometers on one wire (DS18B20): red to 5V, black to GND, yellow (data) to pin 2, with one resistor of 4.7 kOhm from
// data to 5V for all of them.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipThermometers.h>

asip::OneWireBus bus(2);
asip::ThermometersOf<8> thermometers(bus);

void setup() {
    asip::board.add(thermometers);
    asip::board.begin(ASIP_NAME("AsipThermometers"));
}

void loop() { asip::board.run(); }
