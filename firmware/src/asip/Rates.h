// SPDX-License-Identifier: Apache-2.0
// What line rates a chip can make from its clock: by a whole divisor of a sixteenth or an eighth of it.
#pragma once

#include <stdint.h>

namespace asip {

// The divisor that comes closest to `baud`.
constexpr uint32_t divisorFor(uint32_t clock, uint32_t baud) {
    return (clock + baud / 2) / baud;
}

// True if `clock` divided by it is within 2.5 % of `baud`.
constexpr bool canDivideTo(uint32_t clock, uint32_t baud) {
    return divisorFor(clock, baud) != 0 && clock / divisorFor(clock, baud) * 40 <= baud * 41 &&
           clock / divisorFor(clock, baud) * 40 >= baud * 39;
}

}  // namespace asip
