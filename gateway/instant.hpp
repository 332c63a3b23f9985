// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/text/wall_time.hpp"
#include "asip/time.hpp"

namespace asip::gateway {

/// The two clocks at one moment: one to measure with, one to show. A change of the machine's clock
/// changes the second only.
struct Instant {
    Time time{};            ///< steady
    text::WallTime wall{};  ///< of day
};

}  // namespace asip::gateway
