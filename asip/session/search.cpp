// SPDX-License-Identifier: Apache-2.0
#include "asip/session/search.hpp"

#include <utility>

#include "asip/session/rate_change.hpp"

namespace asip::session {

namespace {
constexpr Duration kAtStartRate = std::chrono::milliseconds(600);
constexpr Duration kAtOtherRates = std::chrono::milliseconds(200);
}  // namespace

void Search::start(unsigned start_baud, bool rates, Time quiet_until, Time now) {
    rates_.assign(1, start_baud);
    if (rates)
        for (unsigned rate : {500'000u, 1'000'000u, 250'000u, 115'200u})
            if (rate != start_baud) rates_.push_back(rate);
    index_ = 0;
    round_ = 0;
    heard_ = false;
    quiet_until_ = quiet_until;
    deadline_ = now;
}

Search::Step Search::next(Time now) {
    const unsigned baud = rates_[index_];
    if (now < quiet_until_) {
        deadline_ = quiet_until_;
        return {baud, false, false};
    }
    // At the start rate twice, the second time behind a newline.
    const bool at_start = index_ == 0;
    const Step step{baud, true, !at_start || round_ % 2 == 1};
    deadline_ = now + (at_start ? kAtStartRate / 2 : kAtOtherRates);
    ++round_;
    if (!std::exchange(heard_, false) && (round_ % 2 == 0 || !at_start))
        index_ = (index_ + 1) % rates_.size();
    return step;
}

}  // namespace asip::session
