// SPDX-License-Identifier: Apache-2.0
// Services that want what is in use: a servo and the emitters of reflectance sensors on a pin of the serial
// line, a motor whose power pin has its PWM from the servos' timer.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipMotors.h>
#include <AsipReflectance.h>
#include <AsipServos.h>

asip::Motors motors(7, 8, 9);
asip::Servos servos(1);
asip::Reflectance reflectance(1, A0);

void setup() {
    asip::board.add(motors);
    asip::board.add(servos);
    asip::board.add(reflectance);
    asip::board.begin(ASIP_NAME("Conflict"));
}

void loop() { asip::board.run(); }
