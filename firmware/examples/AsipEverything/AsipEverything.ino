// SPDX-License-Identifier: Apache-2.0
// Fifteen services on a Mega, as many as a board has. Take out what you have not; what is missing says so and
// disturbs nothing.
#include <Asip.h>
#include <AsipDht.h>
#include <AsipDistance.h>
#include <AsipEncoders.h>
#include <AsipFastSerial.h>
#include <AsipHygrometer.h>
#include <AsipI2cChips.h>
#include <AsipIlluminance.h>
#include <AsipLcd.h>
#include <AsipMotors.h>
#include <AsipNeoPixels.h>
#include <AsipOneWire.h>
#include <AsipServos.h>
#include <AsipSteppers.h>
#include <AsipThermometers.h>
#include <AsipTone.h>
#include <AsipWeather.h>

asip::Dht climate(asip::Dht::kDht22, 10);
asip::OneWireBus wire(22);
asip::ThermometersOf<8> thermometers(wire);
asip::OneWire oneWire(wire);

// On the I2C pins, 20 and 21.
asip::Weather weather;
asip::Hygrometer hygrometer;
asip::Illuminance illuminance;
asip::Lcd lcd;
asip::I2cChips chips;

asip::Distance distance(23, 24);
asip::Servos servos(25, 26);
asip::Stepper dial(28, 29, 30, 31);
asip::Stepper slide(32, 33, 34);
asip::Steppers steppers(dial, slide);
asip::Tone buzzer(27);
asip::Motors motors(36, 37, 5, 38, 39, 6);
asip::Encoders encoders(2, 40, 3, 41);
asip::PixelStripOf<8> strip(42);
asip::NeoPixels pixels(strip);

void setup() {
    slide.useHomeSwitch(35).holdAtRest();
    asip::Service* const all[] = {&climate,     &thermometers, &oneWire, &weather,  &hygrometer,
                                  &illuminance, &lcd,          &chips,   &distance, &servos,
                                  &steppers,    &buzzer,       &motors,  &encoders, &pixels};
    for (asip::Service* service : all)
        asip::board.add(*service);
    asip::board.begin(ASIP_NAME("AsipEverything"));
}

void loop() {
    asip::board.run();
}
