// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/echo.hpp"

#include <cmath>

namespace asip::sim {
namespace {

// Sound at 20 degrees: 343 m/s, there and back.
constexpr double kEchoMicrosecondsPerCm = 58.31;
constexpr double kMaxRangeCm = 400;
constexpr double kMinTriggerUs = 2;
// From the trigger's end to the echo's beginning.
constexpr double kBurstUs = 450;
// How long the usual sensors hold their echo when none came back.
constexpr double kNothingInRangeUs = 38000;

}  // namespace

Echo::Echo(PartContext& context, int trigger, int echo, Measure measure)
    : context_(context),
      trigger_(trigger),
      echo_(echo),
      measure_(std::move(measure)),
      next_(context.clock, [this] { step(); }) {
    context.wiring.watch(trigger, [this](PinState pin) { on_trigger(pin); });
    if (!one_pin()) context.wiring.drive(echo, false);
}

std::uint64_t Echo::cycles(double microseconds) const {
    return static_cast<std::uint64_t>(std::llround(microseconds * context_.cycles_per_us));
}

void Echo::on_trigger(PinState pin) {
    if (phase_ != Phase::kIdle) return;
    const auto now = context_.clock.cycle();
    if (pin.output && pin.high) {
        if (!rose_at_) rose_at_ = now;
        return;
    }
    const bool triggered = rose_at_ && now - *rose_at_ >= cycles(kMinTriggerUs);
    rose_at_.reset();
    if (!triggered) return;
    const auto distance = measure_();
    if (!distance) return;
    distance_cm_ = *distance;
    phase_ = Phase::kBurst;
    context_.wiring.drive(echo_, false);
    next_.at(now + cycles(kBurstUs));
}

void Echo::step() {
    if (phase_ == Phase::kBurst) {
        phase_ = Phase::kEcho;
        context_.wiring.drive(echo_, true);
        // From the moment the pin really rose: the width of the pulse is the measurement.
        const bool in_range = distance_cm_ <= kMaxRangeCm;
        next_.at(context_.clock.cycle() +
                 cycles(in_range ? distance_cm_ * kEchoMicrosecondsPerCm : kNothingInRangeUs));
        return;
    }
    phase_ = Phase::kIdle;
    context_.wiring.drive(echo_, false);
    if (one_pin()) context_.wiring.release(echo_);
}

}  // namespace asip::sim
