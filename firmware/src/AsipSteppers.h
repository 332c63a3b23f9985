// SPDX-License-Identifier: Apache-2.0
// One or two stepper motors: 28BYJ-48 with a ULN2003 (four pins), or any with a driver that takes step and
// direction, as the A4988 (three pins: step, direction, enable):
//
//   asip::Stepper dial(8, 9, 10, 11);
//   asip::Stepper slide(2, 3, 4);
//   asip::Steppers steppers(dial, slide);     // and in setup(), before begin: slide.useHomeSwitch(12);
//
// Y,G,motor,position goes to a position, Y,R,motor,steps so far on from where it is to go; Y,V,motor,speed
// and Y,C,motor,acceleration set how, in steps a second (1 to 4000, 500 at first) and a second (1 to 65535,
// 1000). A new position is taken at once: what moves turns round at its ramp if it has to. Y,H,motor,steps
// moves until the home switch is closed, where the position is 0, so many steps at most; negative ones
// backwards. Y,s,motor and Y,S stop at once; Y,P,motor,1 gives power at rest and 0 takes it away, as it is at
// first, a tenth of a second behind the last step, or at once where it was stopped.
//
// Y,M and Y,A,ms report, and each motor that comes to rest does: @Y,e,2,{1200:0:1,0:1:0}, position, whether
// it moves, and whether the switch has said where it is. A timer makes the steps; nothing of the line delays
// one.
//
// Timer 1 makes them, beside servos and tones: its pins (Uno 9 and 10, Leonardo 9 to 11, Mega 11 to 13) have
// no PWM then but where another timer makes it (Leonardo 10 and 11, Mega 13).
#pragma once

#if defined(ARDUINO) && !defined(__AVR__)
#error "AsipSteppers.h makes its steps with a timer of an AVR: there is none on this chip"
#endif

#include "Asip.h"
#include "asip/parts/Stepper.h"

namespace asip {

class Steppers : public Service {
  public:
    // A service has to be a global: what is not set here is zero.
    template <typename... Motors>
    explicit Steppers(Motors&... motors)
        : Service('Y', sizeof...(Motors)), motors_{Motor{&motors, 0, kAtRest, 0}...} {
        static_assert(sizeof...(Motors) > 0 && sizeof...(Motors) <= StepTimer::kMaxSteppers,
                      "one or two motors");
    }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;
    void poll() override;

  private:
    enum State : uint8_t { kAtRest, kSettling, kGoing, kHoming };
    struct Motor {
        Stepper* stepper;
        int32_t target;
        State state;
        uint8_t sinceMs;
    };

    Error go(Motor& motor, int32_t target);
    Error home(Motor& motor, int32_t steps);
    void stop(Motor& motor);
    void follow(Motor& motor);

    Motor motors_[StepTimer::kMaxSteppers];
    bool isAvailable_;
    bool isNews_;  // one came to rest
};

}  // namespace asip
