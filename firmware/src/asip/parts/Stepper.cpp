// SPDX-License-Identifier: Apache-2.0
#include "Stepper.h"

#ifdef __AVR__
#include <Arduino.h>

// Servos have comparison A, and a tone B, where the core has no other timer for it.
#ifdef OCR1C
#define ASIP_STEP_TICK OCR1C
#define ASIP_STEP_FLAG OCF1C
#define ASIP_STEP_ENABLE OCIE1C
#define ASIP_STEP_VECTOR TIMER1_COMPC_vect
#else
#define ASIP_STEP_TICK OCR1B
#define ASIP_STEP_FLAG OCF1B
#define ASIP_STEP_ENABLE OCIE1B
#define ASIP_STEP_VECTOR TIMER1_COMPB_vect
#endif

namespace asip {

// A tick is 1,024 cycles, 64 microseconds at 16 MHz. Each fourth one changes the speed of a motor.
static constexpr uint8_t kTick = 128;
static constexpr double kTicksPerSecond = F_CPU / 1024.0, kWhole = 4294967296.0;
static constexpr uint32_t kSpeedUnit = static_cast<uint32_t>(kWhole / kTicksPerSecond);
static constexpr uint16_t kGainUnit64 =
    static_cast<uint16_t>(4 * 64 * kWhole / kTicksPerSecond / kTicksPerSecond);
static constexpr uint8_t kSlowestShift = 5;  // what 128 ticks of acceleration give
static constexpr uint8_t kPulseMicroseconds = 2;

static Stepper* const* motors;
static uint8_t motorCount;

void StepTimer::use(Stepper* const* steppers, uint8_t count) {
    TIMSK1 &= static_cast<uint8_t>(~_BV(ASIP_STEP_ENABLE));
    motors = steppers;
    motorCount = count;
}

void StepTimer::start() {
    if (TIMSK1 & _BV(ASIP_STEP_ENABLE)) return;
    TCCR1A = 0;
    TCCR1B = _BV(CS11);
    ASIP_STEP_TICK = TCNT1 + kTick;
    TIFR1 = _BV(ASIP_STEP_FLAG);
    TIMSK1 |= _BV(ASIP_STEP_ENABLE);
}

void Stepper::begin() {
    for (uint8_t i = 0; i < pinCount_; ++i) {
        digitalWrite(pins_[i], LOW);
        pinMode(pins_[i], OUTPUT);
        lines_[i].input = portInputRegister(digitalPinToPort(pins_[i]));
        lines_[i].mask = digitalPinToBitMask(pins_[i]);
    }
    if (hasHomeSwitch()) {
        pinMode(homePin_, INPUT_PULLUP);
        home_.input = portInputRegister(digitalPinToPort(homePin_));
        home_.mask = digitalPinToBitMask(homePin_);
    }
    left_ = position_ = 0;
    isMoving_ = isHomed = false;
    adjust();
    setPower(holds);
}

// Coils: 0 is the first alone, 1 the first and the second, 2 the second alone, and so on.
void Stepper::setPower(bool on) {
    if (pinCount_ != 4) return digitalWrite(pins_[2], !on);
    for (uint8_t coil = 0; coil < 4; ++coil) {
        const uint8_t behind = static_cast<uint8_t>(phase_ - 2 * coil + 1) & 7;
        digitalWrite(pins_[coil], on && behind <= 2);
    }
}

void Stepper::adjust() {
    const uint32_t top = speed * kSpeedUnit, gain = static_cast<uint32_t>(acceleration) * kGainUnit64 >> 6;
    const uint32_t slowest = gain << kSlowestShift;
    noInterrupts();
    top_ = top;
    gain_ = gain;
    slowest_ = slowest < top ? slowest : top;
    interrupts();
}

void Stepper::move(int32_t steps, bool homing) {
    isBackward_ = steps < 0;
    if (pinCount_ != 4) digitalWrite(pins_[1], !isBackward_);
    setPower(true);
    noInterrupts();
    left_ = static_cast<uint32_t>(isBackward_ ? -steps : steps);
    now_ = slowest_;
    part_ = ramp_ = 0;
    isHoming_ = homing;
    isMoving_ = true;
    StepTimer::start();
    interrupts();
}

void Stepper::aimAt(int32_t position) {
    noInterrupts();
    const int32_t way = isBackward_ ? position_ - position : position - position_;
    left_ = way > 0 && static_cast<uint32_t>(way) >= ramp_ ? static_cast<uint32_t>(way) : ramp_;
    interrupts();
}

void Stepper::stop() {
    noInterrupts();
    left_ = 0;
    isMoving_ = false;
    interrupts();
}

int32_t Stepper::position() const {
    noInterrupts();
    const int32_t position = position_;
    interrupts();
    return position;
}

// From one half step to the next a single coil changes.
inline void Stepper::step() {
    --left_;
    if (trend_ > 0) {
        ++ramp_;
    } else if (trend_ < 0 && ramp_ != 0) {
        --ramp_;
    }
    if (isBackward_) {
        --position_;
    } else {
        ++position_;
    }
    if (pinCount_ != 4) {
        *lines_[0].input = lines_[0].mask;
        __builtin_avr_delay_cycles(F_CPU / 1000000 * kPulseMicroseconds);
        *lines_[0].input = lines_[0].mask;
        return;
    }
    if (isBackward_) --phase_;
    const uint8_t between = phase_ & 7;
    if (!isBackward_) ++phase_;
    const uint8_t coil = between & 1 ? between >> 1 : ((between >> 1) + 1) & 3;
    *lines_[coil].input = lines_[coil].mask;
}

inline void Stepper::changeSpeed() {
    if (left_ <= ramp_ || now_ > top_) {
        now_ = now_ > slowest_ + gain_ ? now_ - gain_ : slowest_;
        trend_ = -1;
    } else if (now_ < top_) {
        now_ += gain_;
        if (now_ > top_) now_ = top_;
        trend_ = 1;
    } else {
        trend_ = 0;
    }
}

inline bool Stepper::tick(bool changesSpeed) {
    if (!isMoving_) return false;
    if (isHoming_ && !(*home_.input & home_.mask)) {
        left_ = 0;
        position_ = 0;
        isHomed = true;
    }
    if (left_ == 0) {
        isMoving_ = false;
        return false;
    }
    if (changesSpeed) changeSpeed();
    part_ += now_;
    if (part_ < now_) step();
    return true;
}

}  // namespace asip

ISR(ASIP_STEP_VECTOR) {
    using namespace asip;
    // A tick that comes late must not miss its next moment, which would come round only after 33 ms.
    const uint16_t next = ASIP_STEP_TICK + kTick;
    const uint16_t soonest = TCNT1 + 8;
    ASIP_STEP_TICK = static_cast<int16_t>(next - soonest) < 0 ? soonest : next;
    // The others go on meanwhile: 30 microseconds would cost a byte of the line at 1,000,000 baud.
    TIMSK1 &= static_cast<uint8_t>(~_BV(ASIP_STEP_ENABLE));
    sei();
    static uint8_t ticks;
    const uint8_t turn = ++ticks & 3;
    bool moves = false;
    for (uint8_t i = 0; i < motorCount; ++i)
        moves |= motors[i]->tick(turn == i);
    cli();
    if (moves) TIMSK1 |= _BV(ASIP_STEP_ENABLE);
}

#endif
