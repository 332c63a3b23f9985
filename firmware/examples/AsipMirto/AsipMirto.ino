// SPDX-License-Identifier: Apache-2.0
// The robot of the ASIP papers (MIRTO, its board with an ATmega328), on its published pins: two motors with encoders, two
// bump sensors, three reflectance sensors, a servo that turns a distance sensor.
#include <Asip.h>
#include <AsipBump.h>
#include <AsipDistance.h>
#include <AsipEncoders.h>
#include <AsipFastSerial.h>
#include <AsipMotors.h>
#include <AsipReflectance.h>
#include <AsipServos.h>

asip::Motors motors(8, 11, 5, 12, 13, 6);
asip::Encoders encoders(3, 7, 2, 4);
asip::Bump bump(9, 10);
asip::Reflectance reflectance(14, 15, 16, 17);
asip::Servos servo(18);
asip::Distance distance(19);

void setup() {
    motors.report(encoders);  // to clients that ask for them by M,A
    asip::board.add(motors);
    asip::board.add(encoders);
    asip::board.add(bump);
    asip::board.add(reflectance);
    asip::board.add(servo);
    asip::board.add(distance);
    asip::board.begin(ASIP_NAME("AsipMirto"));
}

void loop() { asip::board.run(); }
