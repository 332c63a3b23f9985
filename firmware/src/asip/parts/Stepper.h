// SPDX-License-Identifier: Apache-2.0
// One stepper motor, whose steps timer 1 makes: it counts eighths of the clock and is never stopped, as for
// servos and tones, of which each has a comparison of its own. Position, speed and ramp are the timer's.
#pragma once

#include <stdint.h>

namespace asip {

class Stepper {
  public:
    static constexpr uint8_t kNoPin = 255;
    static constexpr uint16_t kFastest = 4000;  // steps a second

    // Four coils behind a ULN2003 (28BYJ-48), in half steps. A global: what is not set here is zero.
    Stepper(uint8_t in1, uint8_t in2, uint8_t in3, uint8_t in4)
        : speed(500), acceleration(1000), homePin_(kNoPin), pins_{in1, in2, in3, in4}, pinCount_(4) {}

    // A driver with step and direction (A4988, DRV8825); the enable pin is low while it has power.
    Stepper(uint8_t step, uint8_t direction, uint8_t enable)
        : speed(500), acceleration(1000), homePin_(kNoPin), pins_{step, direction, enable}, pinCount_(3) {}

    // For the sketch, before the board begins: a switch from this pin to GND, closed where the position is 0;
    // and that the motor holds its place when it is at rest.
    Stepper& useHomeSwitch(uint8_t pin) {
        homePin_ = pin;
        return *this;
    }
    Stepper& holdAtRest() {
        holds = true;
        return *this;
    }

    uint8_t pinCount() const { return static_cast<uint8_t>(pinCount_ + hasHomeSwitch()); }
    uint8_t pin(uint8_t index) const { return index < pinCount_ ? pins_[index] : homePin_; }
    bool hasHomeSwitch() const { return homePin_ != kNoPin; }

    // Its pins are claimed: at rest at position 0, without power unless it holds.
    void begin();
    void setPower(bool on);

    // One that is at rest begins to move, by not 0 steps; with `homing` until the switch is closed, where the
    // position is 0.
    void move(int32_t steps, bool homing);
    bool isMoving() const { return isMoving_; }

    // One that moves goes on to this position if it can do so at its ramp without turning round; else it
    // slows down to rest.
    void aimAt(int32_t position);
    void stop();  // at once
    int32_t position() const;

    // `speed` or `acceleration` has changed.
    void adjust();

    uint16_t speed, acceleration;  // steps a second, and a second; neither is 0
    bool holds;                    // has power at rest
    bool isHomed;                  // the switch said where it is

    // For the timer: true while it moves.
    bool tick(bool changesSpeed) __attribute__((always_inline));

  private:
    void changeSpeed() __attribute__((always_inline));
    void step() __attribute__((always_inline));

    // Speeds are in 1 / 2^32 step a tick; the gain is added at each fourth tick.
    uint32_t now_, top_, slowest_, gain_;
    uint32_t part_;  // of the next step
    uint32_t left_;  // steps
    uint32_t ramp_;  // steps that it takes to slow down
    int32_t position_;
    volatile bool isMoving_;
    bool isHoming_, isBackward_;
    int8_t trend_;   // of the ramp, with each step
    uint8_t phase_;  // of eight
    uint8_t homePin_;
    uint8_t pins_[4];
    uint8_t pinCount_;
    struct {
        volatile uint8_t* input;  // a 1 written there turns an output over
        uint8_t mask;
    } lines_[4], home_;
};

// The timer of all motors that run.
class StepTimer {
  public:
    static constexpr uint8_t kMaxSteppers = 2;  // more would keep a byte of the line waiting for too long

    // The motors, which stay where they are; none moves.
    static void use(Stepper* const* steppers, uint8_t count);
    static void start();
};

}  // namespace asip
