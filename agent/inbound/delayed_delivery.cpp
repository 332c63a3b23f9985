// SPDX-License-Identifier: Apache-2.0
#include "agent/inbound/delayed_delivery.hpp"

#include <algorithm>
#include <utility>

namespace asip::agent {

bool DelayedDelivery::commanded(Time now, bool qos1) {
    in_use_until_ = now + kInUse;
    if (qos1) ++came_;
    if (due_) return false;
    due_ = good_ = now;
    return true;
}

void DelayedDelivery::process_paused(Time now, Time since) {
    if (arrival(since) == since) good_ = since;
    behind_ = true;
    drained_by_ = now + kDraining;
    worthless_ = sent_.has_value();
    due_ = now;
}

void DelayedDelivery::sent(Time now) {
    sent_ = now;
    came_ = 0;
}

bool DelayedDelivery::answered(Time now) {
    if (!sent_) return false;
    if (std::exchange(worthless_, false)) {
        due_ = now;
        sent_.reset();
        return false;
    }
    const bool late = now > *due_ + limit();
    took_[answers_++ % took_.size()] = now - *due_;
    if (late) drained_by_ = now + kDraining;
    behind_ = late || (behind_ && came_ >= kWindow && now < drained_by_);
    if (behind_) {
        due_ = now + kCatchingUp;
    } else {
        good_ = *sent_;
        due_ = std::max(now, *sent_ + kEvery);
        if (*due_ > in_use_until_) due_.reset();
    }
    sent_.reset();
    return late;
}

Time DelayedDelivery::arrival(Time now) const {
    const bool delayed = behind_ || (due_ && now > *due_ + limit());
    const bool given_up = sent_ && now >= *due_ + kNoAnswer;
    return delayed && !given_up ? std::min(good_, now) : now;
}

// The median, so that neither one stall nor one quick answer counts.
Duration DelayedDelivery::limit() const {
    constexpr std::size_t kEnough = 3;
    if (answers_ < kEnough) return kLate;
    auto known = took_;
    const std::size_t count = std::min(answers_, known.size());
    const auto middle = known.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(known.begin(), middle, known.begin() + static_cast<std::ptrdiff_t>(count));
    return std::max(kLate, kTimesUsual * *middle);
}

}  // namespace asip::agent
