// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/wheel_encoder.hpp"

#include <array>
#include <cmath>

namespace asip::sim {

WheelEncoder::WheelEncoder(PartContext& context, int first, int second, double cycles_per_radian)
    : context_(context),
      first_(first),
      second_(second),
      quarters_per_radian_(4 * cycles_per_radian),
      next_(context.clock, [this] { edge(); }) {
    put();
}

void WheelEncoder::put() {
    constexpr std::array<bool, 4> kFirst = {false, true, true, false}, kSecond = {false, false, true, true};
    const auto phase = static_cast<std::size_t>((quarter_ % 4 + 4) % 4);
    context_.wiring.drive(first_, kFirst[phase]);
    context_.wiring.drive(second_, kSecond[phase]);
}

void WheelEncoder::turn_to(double turned, std::uint64_t cycles) {
    // Edges of the time before that are still due: none is left out.
    while (std::floor(to_) != static_cast<double>(quarter_)) {
        quarter_ += std::floor(to_) > static_cast<double>(quarter_) ? 1 : -1;
        put();
    }
    from_ = to_;
    to_ = turned * quarters_per_radian_;
    began_ = context_.clock.cycle();
    took_ = cycles;
    schedule();
}

/// The next edge: where the wheel passes from one quarter into the next or the one before.
void WheelEncoder::schedule() {
    next_.cancel();
    if (std::floor(to_) == static_cast<double>(quarter_)) return;
    const double boundary = static_cast<double>(to_ > from_ ? quarter_ + 1 : quarter_);
    const double share = (boundary - from_) / (to_ - from_);
    next_.at(began_ + static_cast<std::uint64_t>(std::max(0.0, share) * static_cast<double>(took_)));
}

void WheelEncoder::edge() {
    quarter_ += to_ > from_ ? 1 : -1;
    put();
    schedule();
}

}  // namespace asip::sim
