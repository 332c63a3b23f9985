// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "sim/wiring/part_context.hpp"

namespace asip::sim {

/// The encoder of a wheel: two pins whose signals are a quarter of a cycle apart, each edge at the moment at
/// which the wheel gets there. The first pin leads while the wheel turns forwards as it sees it. Needs a
/// timer of the simulator.
class WheelEncoder {
  public:
    WheelEncoder(PartContext& context, int first, int second, double cycles_per_radian);

    /// From now on the wheel turns evenly from where the last call ended to `turned` (radians), in `cycles`
    /// of the chip.
    void turn_to(double turned, std::uint64_t cycles);

  private:
    void put();
    void schedule();
    void edge();

    PartContext& context_;
    int first_;
    int second_;
    double quarters_per_radian_;
    Alarm next_;
    std::int64_t quarter_ = 0;  // shown by the pins
    double from_ = 0, to_ = 0;  // in quarters
    std::uint64_t began_ = 0;   // cycle
    std::uint64_t took_ = 1;    // cycles
};

}  // namespace asip::sim
