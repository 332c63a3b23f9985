// SPDX-License-Identifier: Apache-2.0
#include "AsipDht.h"

#ifdef ARDUINO

#include <Arduino.h>

#include "asip/parts/DhtPulses.h"

namespace asip {

// From the data sheets: they want two seconds of rest, also after power came. Their answer takes 5 ms.
static constexpr uint16_t kRestMs = 2000, kOldMs = 5000;
static constexpr uint8_t kAnswerMs = 8;

FlashText Dht::name() const {
    return ASIP_NAME("Climate");
}

Dht::Sensor& Dht::at(uint8_t sensor) {
    return sensors_[sensor];
}

void Dht::begin() {
    state_ = kIdle;
    isOld_ = true;
    sinceMs_ = hw::shortMilliseconds();
    for (uint8_t i = 0; i < count(); ++i) {
        board.claimPin(pins_[i], *this);
        Sensor& sensor = at(i);
        sensor.temperature = kNoValue;
        sensor.damaged = sensor.silent = 0;
    }
}

Error Dht::processRequest(Request& request) {
    const char tag = request.tag();
    if (tag != 'M' && tag != 'E') return Error::kUnknownRequest;
    if (!request.complete()) return Error::kBadArgument;
    if (tag == 'E') {
        board.sendList(*this, tag, count());
    } else {
        reportValues();
    }
    return Error::kNone;
}

void Dht::reportValues() {
    if (state_ == kIdle) state_ = kResting;  // else what is being measured is the answer to this too
}

void Dht::reportValue(uint8_t index) {
    const Sensor& sensor = at(index);
    if (board.listTag() == 'E') return out.pair(sensor.damaged, sensor.silent);
    if (sensor.temperature == kNoValue) return;
    out.shortHundredths(static_cast<int16_t>(sensor.temperature * 10));
    out.character(':');
    out.shortHundredths(static_cast<int16_t>(sensor.humidity * 10));
}

// Two bytes of an answer: a whole number and tenths, or tenths, with the sign in the highest bit of these.
int16_t Dht::tenths(const uint8_t* bytes) const {
    const bool isDht11 = kind_ == kDht11;
    const uint8_t high = bytes[0], low = bytes[1];
    const int16_t value =
        static_cast<int16_t>(isDht11 ? high * 10 + (low & 0x7f) : (high & 0x07) << 8 | low);  // 204.7 at most
    return (isDht11 ? low : high) & 0x80 ? static_cast<int16_t>(-value) : value;
}

// Ends the answer of a sensor.
void Dht::take() {
    Sensor& sensor = at(sensor_++);
    state_ = kNext;
    sensor.temperature = kNoValue;
    const uint8_t* const bytes = DhtPulses::bytes();
    uint8_t sum = 0;
    for (uint8_t i = 0; i < 4; ++i)
        sum = static_cast<uint8_t>(sum + bytes[i]);
    if (DhtPulses::areComplete() && sum == bytes[4]) {
        sensor.humidity = tenths(bytes);
        sensor.temperature = tenths(bytes + 2);
        return;
    }
    uint8_t& counter = DhtPulses::areNone() ? sensor.silent : sensor.damaged;
    if (counter != 255) ++counter;
}

// A sensor whose pin is in use elsewhere is passed over. Behind the last, old answers are asked for again.
void Dht::turnToNext() {
    if (sensor_ == count()) {
        state_ = isOld_ ? kResting : kReporting;
        isOld_ = false;
        return;
    }
    const uint8_t pin = pins_[sensor_];
    if (!board.ownsPin(pin, *this)) {
        ++sensor_;
        return;
    }
    digitalWrite(pin, LOW);
    pinMode(pin, OUTPUT);
    state_ = kWaking;
}

void Dht::poll() {
    const uint16_t ms = hw::shortMilliseconds();
    const uint16_t passed = static_cast<uint16_t>(ms - sinceMs_);
    if (state_ == kIdle) {
        if (passed <= kOldMs) return;
        isOld_ = true;
        sinceMs_ = static_cast<uint16_t>(ms - kOldMs);  // however long it lasts
    } else if (state_ == kResting) {
        if (passed <= kRestMs) return;
        sensor_ = 0;
        state_ = kNext;
    } else if (state_ == kNext) {
        sinceMs_ = ms;
        turnToNext();
    } else if (state_ == kWaking) {
        if (passed <= kind_) return;
        sinceMs_ = ms;
        state_ = kListening;
        DhtPulses::start(pins_[sensor_]);
    } else if (state_ == kListening) {
        if (DhtPulses::areComplete() || passed > kAnswerMs) take();
    } else if (out.hasRoom()) {
        state_ = kIdle;
        board.sendList(*this, 'e', count());
    }
}

}  // namespace asip

#endif
