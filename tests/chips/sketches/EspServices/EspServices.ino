// SPDX-License-Identifier: Apache-2.0
// Every service that needs no hardware of an AVR, on pins that an ESP8266 and an ESP32 have. Compiled only.
#include <Asip.h>
#include <AsipBump.h>
#include <AsipDistance.h>
#include <AsipEncoders.h>
#include <AsipMotors.h>
#include <AsipOneWire.h>
#include <AsipReflectance.h>
#include <AsipSerial.h>
#include <AsipTone.h>

asip::Motors motors(2, 4, 5);
asip::Encoders encoders(12, 13);
asip::Bump bump(14);
asip::Reflectance reflectance(15, A0);
asip::Distance distance(16);
asip::Tone buzzer(0);
asip::OneWireBus wire(3);
asip::OneWire oneWire(wire);

void setup() {
    asip::board.add(motors);
    asip::board.add(encoders);
    asip::board.add(bump);
    asip::board.add(reflectance);
    asip::board.add(distance);
    asip::board.add(buzzer);
    asip::board.add(oneWire);
    asip::board.begin(ASIP_NAME("EspServices"));
}

void loop() { asip::board.run(); }
