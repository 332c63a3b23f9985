// SPDX-License-Identifier: Apache-2.0
// Thermometers, and beside them the service by which programs reach any device on their wire.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipOneWire.h>
#include <AsipThermometers.h>

asip::OneWireBus bus(2);
asip::ThermometersOf<8> thermometers(bus);
asip::OneWire oneWire(bus);

void setup() {
    asip::board.add(thermometers);
    asip::board.add(oneWire);
    asip::board.begin(ASIP_NAME("OneWire"));
}

void loop() { asip::board.run(); }
