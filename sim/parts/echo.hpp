// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>

#include "sim/wiring/part_context.hpp"

namespace asip::sim {

/// The electrical side of an ultrasonic distance sensor: after a trigger pulse the echo pin goes high for as
/// long as the sound was on its way. With `echo` equal to `trigger` the echo comes back on the pin that
/// triggered it. Needs a timer of the simulator.
class Echo {
  public:
    /// Centimetres to what is in front at the moment of the trigger (above 400: no echo, as when nothing is
    /// in range); nothing where the sensor does not answer at all.
    using Measure = std::function<std::optional<double>()>;
    Echo(PartContext& context, int trigger, int echo, Measure measure);

  private:
    enum class Phase { kIdle, kBurst, kEcho };

    bool one_pin() const { return echo_ == trigger_; }
    std::uint64_t cycles(double microseconds) const;
    void on_trigger(PinState pin);
    void step();

    PartContext& context_;
    int trigger_;
    int echo_;
    Measure measure_;
    Alarm next_;
    Phase phase_ = Phase::kIdle;
    double distance_cm_ = 0;
    std::optional<std::uint64_t> rose_at_;
};

}  // namespace asip::sim
