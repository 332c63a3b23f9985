// SPDX-License-Identifier: Apache-2.0
// A DHT11 on pin 4, alone.
#include <Asip.h>
#include <AsipDht.h>
#include <AsipFastSerial.h>

asip::Dht climate(asip::Dht::kDht11, 4);

void setup() {
    asip::board.add(climate);
    asip::board.begin(ASIP_NAME("Dht11"));
}

void loop() { asip::board.run(); }
