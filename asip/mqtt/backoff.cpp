// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/backoff.hpp"

#include <algorithm>

namespace asip::mqtt {

Duration Backoff::next(const Random& random) {
    const double part = 0.5 + random_unit(random) / 2;
    const auto wait = std::chrono::duration_cast<Duration>(next_ * part);
    next_ = std::min(next_ * 2, max_);
    return wait;
}

}  // namespace asip::mqtt
