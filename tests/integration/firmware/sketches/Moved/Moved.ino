// SPDX-License-Identifier: Apache-2.0
// Each new line of docs/old-sketches.md (test docs_old_sketches_lines), on an Arduino Mega.
#include <Asip.h>
#include <AsipBump.h>
#include <AsipDistance.h>
#include <AsipEncoders.h>
#include <AsipLcd.h>
#include <AsipMotion.h>
#include <AsipMotors.h>
#include <AsipPixels.h>
#include <AsipPressure.h>
#include <AsipReflectance.h>
#define ASIP_SERIAL Serial1
#include <AsipSerial.h>
#include <AsipServos.h>
#include <AsipTone.h>

const uint8_t pin = 22, tonePin = 23;

asip::Servos servos(9, 10);
asip::Distance distance(7, 8);
asip::Motors motors(8, 11, 5, 12, 13, 6);
asip::Encoders encoders(3, 7, 2, 4);
asip::Bump bump(9, 10);
asip::Reflectance reflectance(14, 15, 16, 17);
asip::Tone buzzer(tonePin);
asip::Pixels<18> pixels(pin);

class Mine : public asip::Service {
  public:
    Mine() : Service('X', 2) {}
    asip::FlashText name() const { return ASIP_NAME("Mine"); }
    void begin() { asip::board.claimPin(pin, *this); }
    asip::Error processRequest(asip::Request& request) {
        if (request.tag() != 'M') return asip::Error::kUnknownRequest;
        const uint16_t index = request.number();
        if (!request.complete()) return asip::Error::kBadArgument;
        if (index >= count()) return asip::Error::kInvalidDeviceNumber;
        asip::board.sendList(*this, 'e', count());
        return asip::Error::kNone;
    }
    void reportValue(uint8_t index) {
        const uint8_t value = index;
        asip::out.number(value);
    }
    void poll() {}
};
Mine mine;

void setup() {
    motors.report(encoders);
    asip::board.add(servos);
    asip::board.add(distance);
    asip::board.add(motors);
    asip::board.add(encoders);
    asip::board.add(bump);
    asip::board.add(reflectance);
    asip::board.add(buzzer);
    asip::board.add(pixels);
    asip::board.add(mine);
    asip::board.begin(ASIP_NAME("Mine"));
    asip::board.info(F("text"));
}

void loop() { asip::board.run(); }
