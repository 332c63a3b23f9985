// SPDX-License-Identifier: Apache-2.0
// Every service that needs no hardware of an AVR, on the pins of the MIRTO robot where it has them.
#include <Asip.h>
#include <AsipBump.h>
#include <AsipDistance.h>
#include <AsipEncoders.h>
#include <AsipMotors.h>
#include <AsipOneWire.h>
#include <AsipReflectance.h>
#include <AsipSerial.h>
#include <AsipTone.h>

asip::Motors motors(8, 11, 5, 12, 13, 6);
asip::Encoders encoders(3, 7, 2, 4);
asip::Bump bump(9, 10);
asip::Reflectance reflectance(14, A0, A1, A2);
asip::Distance distance(19, 20);
asip::Tone buzzer(15);
asip::OneWireBus wire(21);
asip::OneWire oneWire(wire);

void setup() {
    asip::board.add(motors);
    asip::board.add(encoders);
    asip::board.add(bump);
    asip::board.add(reflectance);
    asip::board.add(distance);
    asip::board.add(buzzer);
    asip::board.add(oneWire);
    asip::board.begin(ASIP_NAME("ChipServices"));
}

void loop() { asip::board.run(); }
