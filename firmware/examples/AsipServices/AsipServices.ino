// SPDX-License-Identifier: Apache-2.0
// A board with two distance sensors (pins 7 and 8) and two servos (pins 9 and 10) beside its input/output.
#include <Asip.h>
#include <AsipDistance.h>
#include <AsipFastSerial.h>
#include <AsipServos.h>

asip::Distance distance(7, 8);
asip::Servos servos(9, 10);

void setup() {
    asip::board.add(distance);
    asip::board.add(servos);
    asip::board.begin(ASIP_NAME("AsipServices"));
}

void loop() { asip::board.run(); }
