// SPDX-License-Identifier: Apache-2.0
#include "AsipDht.h"

#ifdef ARDUINO

#include "asip/parts/DhtPulses.h"

namespace asip {

// From the data sheets: a DHT11 hears a low of 18 ms, an AM2302 one of 1 ms (20 at most). Both want two
// seconds of rest, also after power came. Their answer takes 5 ms.
static constexpr uint8_t kWakingMs[] = {20, 2};
static constexpr uint16_t kRestMs = 2000, kOldMs = 5000;
static constexpr uint8_t kAnswerMs = 8;

FlashText Dht::name() const {
    return ASIP_NAME("Climate");
}

void Dht::begin() {
    if (state_ == kListening) DhtPulses::stop(pins_[sensor_]);
    state_ = kIdle;
    restedMs_ = 0;
    isOld_ = true;
    lastMs_ = hw::milliseconds();
    for (uint8_t i = 0; i < count(); ++i) {
        board.claimPin(pins_[i], *this);
        sensors_[i] = {kNoValue, kNoValue, 0, 0};
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
    const Sensor& sensor = sensors_[index];
    if (board.listTag() == 'E') {
        out.number(sensor.damaged);
        out.character(':');
        return out.number(sensor.silent);
    }
    if (sensor.temperature == kNoValue) return;
    out.hundredths(sensor.temperature * 10L);
    out.character(':');
    out.hundredths(sensor.humidity * 10L);
}

// A sensor whose pin is in use elsewhere is passed over. Behind the last, old answers are asked for again.
void Dht::turnTo(uint8_t sensor) {
    while (sensor < count() && !board.ownsPin(pins_[sensor], *this))
        ++sensor;
    sensor_ = sensor;
    waitedMs_ = 0;
    if (sensor < count()) return wake();
    state_ = isOld_ ? kResting : kReporting;
    isOld_ = false;
    restedMs_ = 0;
}

void Dht::wake() {
    digitalWrite(pins_[sensor_], LOW);
    pinMode(pins_[sensor_], OUTPUT);
    state_ = kWaking;
}

void Dht::listen() {
    waitedMs_ = 0;
    state_ = kListening;
    if (!DhtPulses::start(pins_[sensor_])) take(0);
}

static void countUp(uint8_t& counter) {
    if (counter != 255) ++counter;
}

// Ends the answer of a sensor, of which so many bits came.
void Dht::take(uint8_t bits) {
    DhtPulses::stop(pins_[sensor_]);
    Sensor& sensor = sensors_[sensor_];
    sensor.temperature = kNoValue;
    const uint8_t* const bytes = DhtPulses::bytes();
    if (bits == 0) {
        countUp(sensor.silent);
    } else if (bits < DhtPulses::kBits ||
               static_cast<uint8_t>(bytes[0] + bytes[1] + bytes[2] + bytes[3]) != bytes[4]) {
        countUp(sensor.damaged);
    } else if (kind_ == kDht11) {
        // Whole numbers and tenths; the sign is with the tenths.
        const int16_t magnitude = static_cast<int16_t>(bytes[2] * 10 + (bytes[3] & 0x7f));
        sensor.humidity = static_cast<int16_t>(bytes[0] * 10 + bytes[1]);
        sensor.temperature = bytes[3] & 0x80 ? static_cast<int16_t>(-magnitude) : magnitude;
    } else {
        const int16_t magnitude = static_cast<int16_t>((bytes[2] & 0x7f) << 8 | bytes[3]);
        sensor.humidity = static_cast<int16_t>(bytes[0] << 8 | bytes[1]);
        sensor.temperature = bytes[2] & 0x80 ? static_cast<int16_t>(-magnitude) : magnitude;
    }
    turnTo(static_cast<uint8_t>(sensor_ + 1));
}

bool Dht::isPassed(uint16_t ms) {
    return waitedMs_ > ms;
}

void Dht::poll() {
    const uint8_t now = hw::milliseconds();
    const uint8_t elapsed = static_cast<uint8_t>(now - lastMs_);
    lastMs_ = now;
    if (restedMs_ <= kOldMs) restedMs_ = static_cast<uint16_t>(restedMs_ + elapsed);
    if (restedMs_ > kOldMs && state_ == kIdle) isOld_ = true;
    waitedMs_ = static_cast<uint16_t>(waitedMs_ + elapsed);
    switch (state_) {
        case kResting:
            if (restedMs_ > kRestMs) turnTo(0);
            return;
        case kWaking:
            if (isPassed(kWakingMs[kind_])) listen();
            return;
        case kListening:
            if (DhtPulses::bits() == DhtPulses::kBits || isPassed(kAnswerMs)) take(DhtPulses::bits());
            return;
        case kReporting:
            if (!out.hasRoom()) return;
            state_ = kIdle;
            board.sendList(*this, 'e', count());
            return;
        default:
            return;
    }
}

}  // namespace asip

#endif
