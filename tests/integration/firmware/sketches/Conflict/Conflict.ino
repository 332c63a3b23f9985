// A servo on a pin that the serial line has.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipServos.h>

asip::Servos servos(1);

void setup() {
    asip::board.add(servos);
    asip::board.begin(F("Conflict"));
}

void loop() { asip::board.run(); }
