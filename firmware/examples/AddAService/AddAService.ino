// The board of docs/service-by-hand.md: two fans beside its pins.
#include <Asip.h>
#include <AsipFastSerial.h>

#include "Fans.h"

Fans fans;

void setup() {
    asip::board.add(fans);
    asip::board.begin(ASIP_NAME("AddAService"));
}

void loop() { asip::board.run(); }
