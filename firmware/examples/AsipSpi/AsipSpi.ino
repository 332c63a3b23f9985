// SPDX-License-Identifier: Apache-2.0
// Any chip on the SPI pins (Uno: 11 to 13, Mega: 50 to 52), for programs that have a driver for it. Pins 9 and 10 choose chips.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipSpi.h>

asip::Spi spi(10, 9);

void setup() {
    asip::board.add(spi);
    asip::board.begin(ASIP_NAME("AsipSpi"));
}

void loop() { asip::board.run(); }
