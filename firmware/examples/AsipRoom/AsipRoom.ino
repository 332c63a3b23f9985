// SPDX-License-Identifier: Apache-2.0
// The air and the light of a room by two boards on the I2C pins: an SHT31 (SHT30, SHT35) and a BH1750.
#include <Asip.h>
#include <AsipFastSerial.h>
#include <AsipHygrometer.h>
#include <AsipIlluminance.h>

asip::Hygrometer air;
asip::Illuminance light;

void setup() {
    asip::board.add(air);
    asip::board.add(light);
    asip::board.begin(ASIP_NAME("AsipRoom"));
}

void loop() { asip::board.run(); }
