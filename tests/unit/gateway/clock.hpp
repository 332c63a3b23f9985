// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/instant.hpp"

namespace asip::gateway {

using namespace std::chrono_literals;

/// A moment of a test: nothing here reads a clock.
inline Instant at(std::chrono::milliseconds since_start) {
    return {Time{} + 1h + since_start,
            text::WallTime(std::chrono::milliseconds(1'700'000'000'000)) + since_start};
}

}  // namespace asip::gateway
