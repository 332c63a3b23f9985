// SPDX-License-Identifier: Apache-2.0
// A two-wheeled robot: motors, wheel encoders, bump and reflectance sensors, and a buzzer.
#include <Asip.h>
#include <AsipBump.h>
#include <AsipEncoders.h>
#include <AsipFastSerial.h>
#include <AsipMotors.h>
#include <AsipReflectance.h>
#include <AsipTone.h>

asip::Motors motors(7, 8, 5, 12, 13, 6);
asip::Encoders encoders(2, 4, 3, 9);
asip::Bump bump(10, 11);
asip::Reflectance reflectance(A3, A0, A1, A2);
asip::Tone buzzer(A4);

void setup() {
    motors.report(encoders);  // to clients that ask for them by M,A
    asip::board.add(motors);
    asip::board.add(encoders);
    asip::board.add(bump);
    asip::board.add(reflectance);
    asip::board.add(buzzer);
    asip::board.begin(ASIP_NAME("AsipRobot"));
}

void loop() { asip::board.run(); }
