// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>

#include "sim/wiring/part_context.hpp"

namespace asip::sim {

/// Listens to the pulses of a hobby servo on a pin (544 us = 0, 2400 us = 180 degrees); others are ignored,
/// as a servo does.
class ServoPulse {
  public:
    /// `changed` is called when the angle is another one.
    ServoPulse(PartContext& context, int pin, std::function<void()> changed);
    /// Whole degrees, 0 to 180; none before the first pulse.
    std::optional<int> angle() const { return angle_; }

  private:
    void on_pin(PinState pin);

    PartContext& context_;
    std::function<void()> changed_;
    std::optional<std::uint64_t> rose_at_;
    std::optional<int> angle_;
};

}  // namespace asip::sim
