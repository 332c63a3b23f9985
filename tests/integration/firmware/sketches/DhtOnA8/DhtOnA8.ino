// SPDX-License-Identifier: Apache-2.0
// A sensor on a pin of port K of a Mega, whose pin-change interrupt is the third.
#include <Asip.h>
#include <AsipDht.h>
#include <AsipFastSerial.h>

asip::Dht climate(asip::Dht::kDht22, A8, A15);

void setup() {
    asip::board.add(climate);
    asip::board.begin(ASIP_NAME("DhtOnA8"));
}

void loop() { asip::board.run(); }
