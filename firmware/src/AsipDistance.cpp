#include "AsipDistance.h"

#ifdef ARDUINO

namespace asip {

static constexpr uint16_t kTimeoutMicroseconds = 25000;  // from the trigger: 4 m there and back, and a margin
static constexpr uint16_t kMicrosecondsPerCentimetre = 58;

// The echo being timed, shared with the interrupt.
enum Phase : uint8_t { kNothing, kBeforeEcho, kInEcho, kEchoOver };
static volatile uint8_t phase;
static volatile uint16_t risenAt, fallenAt;
static uint8_t echoPort, echoMask;

FlashText Distance::name() const {
    return F("Distance");
}

void Distance::begin() {
    phase = kNothing;
    sensor_ = kIdle;
    for (uint8_t i = 0; i < count(); ++i)
        board.claimPin(pins_[i], *this);
}

Error Distance::processRequest(Request& request) {
    if (request.tag() != 'M') return Error::kUnknownRequest;
    if (!request.complete()) return Error::kBadArgument;
    reportValues();
    return Error::kNone;
}

void Distance::reportValues() {
    if (sensor_ != kIdle) return;  // what is being measured is the answer to this too
    sensor_ = 0;
    trigger();
}

void Distance::reportValue(uint8_t index) {
    out.number(centimetres_[index]);
}

// Starts the current sensor, passing over those whose pin was not to be had.
void Distance::trigger() {
    while (sensor_ < count() && !board.ownsPin(pins_[sensor_], *this))
        ++sensor_;
    if (sensor_ == count()) return;
    const uint8_t pin = pins_[sensor_];
    pinMode(pin, OUTPUT);
    digitalWrite(pin, HIGH);
    delayMicroseconds(10);
    digitalWrite(pin, LOW);
    pinMode(pin, INPUT);
    echoPort = digitalPinToPort(pin);
    echoMask = digitalPinToBitMask(pin);
    risenAt = static_cast<uint16_t>(micros());
    phase = kBeforeEcho;
    if (digitalPinToPCICR(pin) == nullptr) return;
    *digitalPinToPCMSK(pin) |= _BV(digitalPinToPCMSKbit(pin));
    *digitalPinToPCICR(pin) |= _BV(digitalPinToPCICRbit(pin));
}

void Distance::poll() {
    if (sensor_ == kIdle) return;
    if (sensor_ == count()) {
        if (!out.hasRoom()) return;
        sensor_ = kIdle;
        return board.sendList(*this, 'e', count());
    }
    noInterrupts();
    onPinChange();
    const uint8_t now = phase;
    const uint16_t waited = static_cast<uint16_t>(micros() - risenAt);
    interrupts();
    if (now == kEchoOver) {
        finish((fallenAt - risenAt + kMicrosecondsPerCentimetre / 2) / kMicrosecondsPerCentimetre);
    } else if (waited > kTimeoutMicroseconds) {
        finish(0);
    }
}

void Distance::finish(uint16_t centimetres) {
    phase = kNothing;
    const uint8_t pin = pins_[sensor_];
    if (digitalPinToPCICR(pin) != nullptr) *digitalPinToPCMSK(pin) &= ~_BV(digitalPinToPCMSKbit(pin));
    centimetres_[sensor_++] = centimetres;
    trigger();
}

void Distance::onPinChange() {
    const bool high = *portInputRegister(echoPort) & echoMask;
    if (phase == kBeforeEcho && high) {
        risenAt = static_cast<uint16_t>(micros());
        phase = kInEcho;
    } else if (phase == kInEcho && !high) {
        fallenAt = static_cast<uint16_t>(micros());
        phase = kEchoOver;
    }
}

}  // namespace asip

ISR(PCINT0_vect) {
    asip::Distance::onPinChange();
}
#if defined(PCINT1_vect)
ISR(PCINT1_vect, ISR_ALIASOF(PCINT0_vect));
#endif
#if defined(PCINT2_vect)
ISR(PCINT2_vect, ISR_ALIASOF(PCINT0_vect));
#endif

#endif
