// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/text/wall_time.hpp"
#include "asip/time.hpp"

namespace asip::gateway {

/// One to measure with, one to show.
struct Instant {
    Time time{};            ///< steady
    text::WallTime wall{};  ///< of day
};

}  // namespace asip::gateway
