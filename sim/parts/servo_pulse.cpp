// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/servo_pulse.hpp"

#include <algorithm>
#include <cmath>

namespace asip::sim {
namespace {

constexpr double kPulseAt0Us = 544;
constexpr double kPulseAt180Us = 2400;
constexpr double kMinPulseUs = 400;
constexpr double kMaxPulseUs = 2600;

}  // namespace

ServoPulse::ServoPulse(PartContext& context, int pin, std::function<void()> changed)
    : context_(context), changed_(std::move(changed)) {
    context.wiring.watch(pin, [this](PinState state) { on_pin(state); });
}

void ServoPulse::on_pin(PinState pin) {
    const auto now = context_.clock.cycle();
    if (pin.high) {
        if (!rose_at_) rose_at_ = now;
        return;
    }
    if (!rose_at_) return;
    const double pulse = static_cast<double>(now - *rose_at_) / context_.cycles_per_us;
    rose_at_.reset();
    if (pulse < kMinPulseUs || pulse > kMaxPulseUs) return;
    const double angle = (pulse - kPulseAt0Us) / (kPulseAt180Us - kPulseAt0Us) * 180;
    const int rounded = static_cast<int>(std::lround(std::clamp(angle, 0.0, 180.0)));
    if (angle_ == rounded) return;
    angle_ = rounded;
    changed_();
}

}  // namespace asip::sim
