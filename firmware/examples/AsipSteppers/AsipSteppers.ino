// SPDX-License-Identifier: Apache-2.0
// Two stepper motors: a 28BYJ-48 whose ULN2003 has IN1 to IN4 at pins 8 to 11, and one behind an A4988 with STEP at pin 2,
// DIR at 3 and ENABLE at 4, whose carriage closes a switch from pin 12 to GND at its home. The second holds its place.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipSteppers.h>

asip::Stepper dial(8, 9, 10, 11);
asip::Stepper slide(2, 3, 4);
asip::Steppers steppers(dial, slide);

void setup() {
    slide.useHomeSwitch(12).holdAtRest();
    asip::board.add(steppers);
    asip::board.begin(ASIP_NAME("AsipSteppers"));
}

void loop() { asip::board.run(); }
