#include "Fans.h"

static const uint8_t kPowerPins[] = {5, 6};
static const uint8_t kTachoPins[] = {2, 4};

void Fans::begin() {
    for (uint8_t fan = 0; fan < kFans; ++fan) {
        asip::board.claimPin(kPowerPins[fan], *this);
        asip::board.claimPin(kTachoPins[fan], *this);
        pinMode(kPowerPins[fan], OUTPUT);
        pinMode(kTachoPins[fan], INPUT_PULLUP);
    }
}

asip::Error Fans::processRequest(asip::Request& request) {
    if (request.tag() == 'W') {
        const uint16_t fan = request.number();
        const uint16_t percent = request.number(100);
        if (!request.complete()) return asip::Error::kBadArgument;
        if (fan >= kFans) return asip::Error::kInvalidDeviceNumber;
        analogWrite(kPowerPins[fan], percent * 255 / 100);
        return asip::Error::kNone;
    }
    if (request.tag() == 'M') {
        if (!request.complete()) return asip::Error::kBadArgument;
        reportValues();
        return asip::Error::kNone;
    }
    return asip::Error::kUnknownRequest;
}

void Fans::reportValue(uint8_t index) {
    asip::out.number(speeds_[index]);
}

void Fans::poll() {
    for (uint8_t fan = 0; fan < kFans; ++fan) {
        const bool high = digitalRead(kTachoPins[fan]);
        if (high && !wasHigh_[fan]) ++pulses_[fan];
        wasHigh_[fan] = high;
    }
    const uint16_t now = millis();
    if (static_cast<uint16_t>(now - since_) < 1000) return;
    since_ = now;
    for (uint8_t fan = 0; fan < kFans; ++fan) {
        speeds_[fan] = pulses_[fan] * 30;  // two pulses a turn, sixty seconds a minute
        pulses_[fan] = 0;
    }
}
