// SPDX-License-Identifier: Apache-2.0
#ifdef __AVR__

#include "AsipSteppers.h"

#include "asip/Hardware.h"

namespace asip {

static constexpr int32_t kFarthest = 100000000;
static constexpr uint8_t kSettleMs = 100;  // from the last step until the power goes

FlashText Steppers::name() const {
    return ASIP_NAME("Steppers");
}

void Steppers::begin() {
    static Stepper* steppers[StepTimer::kMaxSteppers];
    hw::takeTimer(hw::kTimer1);
    isAvailable_ = true;
    isNews_ = false;
    for (uint8_t i = 0; i < count(); ++i) {
        steppers[i] = motors_[i].stepper;
        for (uint8_t pin = 0; pin < steppers[i]->pinCount(); ++pin)
            if (board.claimPin(steppers[i]->pin(pin), *this) != Error::kNone) isAvailable_ = false;
    }
    StepTimer::use(steppers, count());
    for (uint8_t i = 0; isAvailable_ && i < count(); ++i) {
        steppers[i]->begin();
        motors_[i].target = 0;
        motors_[i].state = kAtRest;
    }
}

static int32_t steps(Request& request) {
    request.expect(',');
    const bool backward = request.skip('-');
    const int32_t steps = static_cast<int32_t>(request.item(kFarthest));
    return backward ? -steps : steps;
}

Error Steppers::processRequest(Request& request) {
    const char tag = request.tag();
    const bool ofAll = tag == 'M' || tag == 'S', byWay = tag == 'G' || tag == 'R' || tag == 'H';
    const bool byNumber = tag == 'V' || tag == 'C' || tag == 'P';
    if (!ofAll && !byWay && !byNumber && tag != 's') return Error::kUnknownRequest;
    const uint16_t index = ofAll ? 0 : request.number();
    const int32_t way = byWay ? steps(request) : 0;
    const uint16_t number = byNumber ? request.number(tag == 'V'   ? Stepper::kFastest
                                                      : tag == 'P' ? 1
                                                                   : 65535)
                                     : 0;
    if (!request.complete() || (byNumber && number == 0 && tag != 'P')) return Error::kBadArgument;
    if (index >= count()) return Error::kInvalidDeviceNumber;
    if (!isAvailable_) return Error::kDeviceNotAvailable;
    Motor& motor = motors_[index];
    Stepper& stepper = *motor.stepper;
    switch (tag) {
        case 'M':
            reportValues();
            return Error::kNone;
        case 'G':
            return go(motor, way);
        case 'R':
            return go(motor, motor.target + way);
        case 'H':
            return home(motor, way);
        case 'S':
            for (uint8_t i = 0; i < count(); ++i)
                stop(motors_[i]);
            return Error::kNone;
        case 's':
            stop(motor);
            return Error::kNone;
        case 'P':
            stepper.holds = number != 0;
            if (motor.state == kAtRest) stepper.setPower(stepper.holds);
            return Error::kNone;
        default:
            (tag == 'V' ? stepper.speed : stepper.acceleration) = number;
            stepper.adjust();
            return Error::kNone;
    }
}

Error Steppers::go(Motor& motor, int32_t target) {
    if (target < -kFarthest || target > kFarthest) return Error::kBadArgument;
    if (motor.state == kHoming) return Error::kWrongMode;
    motor.target = target;
    if (motor.stepper->isMoving()) {
        motor.stepper->aimAt(target);
    } else {
        motor.state = kGoing;  // poll() lets it go
    }
    return Error::kNone;
}

Error Steppers::home(Motor& motor, int32_t steps) {
    if (!motor.stepper->hasHomeSwitch()) return Error::kModeUnavailable;
    if (steps == 0) return Error::kBadArgument;
    if (motor.state >= kGoing) return Error::kWrongMode;
    motor.stepper->isHomed = false;
    motor.stepper->move(steps, true);
    motor.state = kHoming;
    return Error::kNone;
}

void Steppers::stop(Motor& motor) {
    motor.stepper->stop();
    motor.target = motor.stepper->position();
    motor.stepper->setPower(motor.stepper->holds);
    if (motor.state >= kGoing) isNews_ = true;
    motor.state = kAtRest;
}

// What has to turn round comes to rest first, and goes on from there.
void Steppers::follow(Motor& motor) {
    Stepper& stepper = *motor.stepper;
    if (motor.state >= kGoing) {
        if (stepper.isMoving()) return;
        const int32_t position = stepper.position();
        if (motor.state == kHoming) motor.target = position;
        if (motor.target != position) return stepper.move(motor.target - position, false);
        motor.state = kSettling;
        motor.sinceMs = hw::milliseconds();
        isNews_ = true;
    } else if (motor.state == kSettling &&
               static_cast<uint8_t>(hw::milliseconds() - motor.sinceMs) > kSettleMs) {
        motor.state = kAtRest;
        stepper.setPower(stepper.holds);
    }
}

void Steppers::poll() {
    if (!isAvailable_) return;
    for (uint8_t i = 0; i < count(); ++i)
        follow(motors_[i]);
    if (!isNews_ || !out.hasRoom()) return;
    isNews_ = false;
    reportValues();
}

void Steppers::reportValue(uint8_t index) {
    const Motor& motor = motors_[index];
    out.signedLongNumber(motor.stepper->position());
    out.character(':');
    out.number(motor.state >= kGoing);
    out.character(':');
    out.number(motor.stepper->isHomed);
}

}  // namespace asip

#endif
