// SPDX-License-Identifier: Apache-2.0
// For tests: steppers and servos, which share timer 1, on a Leonardo with the tone.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipServos.h>
#include <AsipSteppers.h>
#include <AsipTone.h>

asip::Stepper dial(8, 9, 10, 11);
asip::Steppers steppers(dial);
asip::Servos servos(5, 6);
asip::Tone buzzer(4);

void setup() {
    asip::board.add(steppers);
    asip::board.add(servos);
    asip::board.add(buzzer);
    asip::board.begin(ASIP_NAME("SteppersBeside"));
}

void loop() { asip::board.run(); }
