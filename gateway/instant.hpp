// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/text/wall_time.hpp"
#include "asip/time.hpp"

namespace asip::gateway {

/// The two clocks at one moment: one to measure with, one to show.
struct Instant {
    Time time{};
    text::WallTime wall{};
};

}  // namespace asip::gateway
