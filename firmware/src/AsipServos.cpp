#include "AsipServos.h"

#ifdef ARDUINO

namespace asip {

// Timer 1 counts half microseconds and is never stopped. In each frame the pulses follow one another; eight
// of the longest fit.
static constexpr uint16_t kFrameTicks = 40000;
static constexpr uint16_t kShortestTicks = 2 * 544;

// What the interrupt works from. A width of 0 is a servo at rest.
struct Pulse {
    volatile uint8_t* port;
    uint8_t mask;
    volatile uint16_t ticks;
};
static Pulse pulses[Servos::kMaxServos];
static uint8_t pulseCount;
static uint8_t current;
static uint16_t frameStart;

FlashText Servos::name() const {
    return F("Servos");
}

void Servos::begin() {
    attach();
}

// Takes the pins and stops all pulses.
void Servos::attach() {
    TIMSK1 = 0;
    pulseCount = 0;
    for (uint8_t i = 0; i < used_; ++i) {
        const uint8_t pin = pins_[i];
        pulses[i].ticks = 0;
        pulses[i].mask = 0;
        pulses[i].port = &GPIOR0;
        if (board.claimPin(pin, *this) != Error::kNone) continue;
        pinMode(pin, OUTPUT);
        pulses[i].port = portOutputRegister(digitalPinToPort(pin));
        pulses[i].mask = digitalPinToBitMask(pin);
    }
    pulseCount = used_;
    current = used_;
    TCCR1A = 0;
    TCCR1B = _BV(CS11);
    OCR1A = TCNT1 + 100;
    TIFR1 = _BV(OCF1A);
    TIMSK1 = _BV(OCIE1A);
}

Error Servos::processRequest(Request& request) {
    if (request.tag() == 'W') return write(request);
    if (request.tag() == 'M') return remap(request);
    return Error::kUnknownRequest;
}

Error Servos::write(Request& request) {
    const uint16_t servo = request.number();
    const uint16_t angle = request.number(180);
    if (!request.complete()) return Error::kBadArgument;
    if (servo >= used_) return Error::kInvalidDeviceNumber;
    if (pulses[servo].mask == 0) return Error::kDeviceNotAvailable;
    const uint16_t ticks = kShortestTicks + angle * 20 + angle * 28 / 45;  // 3712 ticks for 180 degrees
    noInterrupts();
    pulses[servo].ticks = ticks;
    interrupts();
    return Error::kNone;
}

// All or nothing: the servos stay as they are if one of the pins is not to be had.
Error Servos::remap(Request& request) {
    const uint8_t count = static_cast<uint8_t>(request.number(kMaxServos));
    uint8_t pins[kMaxServos];
    for (uint8_t i = 0; i < count; ++i)
        pins[i] = static_cast<uint8_t>(request.number(255));
    if (!request.complete()) return Error::kBadArgument;
    for (uint8_t i = 0; i < count; ++i) {
        if (!board.canClaim(pins[i], *this)) return Error::kInvalidPin;
        for (uint8_t j = 0; j < i; ++j) {
            if (pins[j] == pins[i]) return Error::kInvalidPin;
        }
    }
    TIMSK1 = 0;
    board.releasePins(*this);
    used_ = count;
    for (uint8_t i = 0; i < count; ++i)
        pins_[i] = pins[i];
    attach();
    return Error::kNone;
}

}  // namespace asip

// Each moment is counted from the one before, not from when the interrupt got to run: only the edges of one
// pulse share in its delay.
ISR(TIMER1_COMPA_vect) {
    using namespace asip;
    uint8_t servo = current;
    if (servo == pulseCount) {
        frameStart = OCR1A;
        servo = 0;
    } else {
        *pulses[servo].port &= static_cast<uint8_t>(~pulses[servo].mask);
        ++servo;
    }
    while (servo < pulseCount && pulses[servo].ticks == 0)
        ++servo;
    current = servo;
    if (servo == pulseCount) {
        OCR1A = frameStart + kFrameTicks;
    } else {
        *pulses[servo].port |= pulses[servo].mask;
        OCR1A += pulses[servo].ticks;
    }
}

#endif
