// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/broker_list.hpp"

#include <algorithm>

namespace asip::mqtt {
namespace {

constexpr int kUnansweredUntilTls = 3;
/// A broker that ends connections as soon as it accepted them may do so to us alone.
constexpr int kClosedSoonUntilNext = 3;
constexpr auto kHeldLongEnough = std::chrono::seconds(5);

}  // namespace

BrokerList::BrokerList(std::vector<BrokerAddress> brokers, Version version, Backoff backoff)
    : version_(version), backoff_(backoff) {
    for (auto& address : brokers)
        brokers_.push_back({std::move(address), VersionChoice(version)});
}

void BrokerList::accepted() {
    auto& broker = brokers_[current_];
    ever_accepted_ = true;
    broker.version.accepted();
    broker.unanswered = 0;
    broker.failed_fatally = false;
}

BrokerList::Next BrokerList::lost(const ConnectionEnd& end, Duration held, const Random& random) {
    using Kind = ConnectionFailure::Kind;
    // A broker that accepts connections and ends them at once must not be asked without a pause.
    const bool good = held >= kHeldLongEnough;
    if (good) backoff_.reset();
    closed_soon_ = good || end.failure.kind != Kind::kClosed ? 0 : closed_soon_ + 1;
    const bool at_once = end.failure.kind != Kind::kStalled && end.failure.kind != Kind::kRefused &&
                         closed_soon_ < kClosedSoonUntilNext;
    const bool others = good && brokers_.size() > 1;
    failures_this_round_ = others ? 0 : brokers_.size();
    const Duration wait = advance(at_once, random);
    if (others) failures_this_round_ = 0;
    return {wait, end.failure};
}

BrokerList::Next BrokerList::failed(const ConnectionEnd& end, bool tried_v5, const Random& random) {
    auto& broker = brokers_[current_];
    broker.version.failed(end, tried_v5);
    broker.unanswered = end.closed_unanswered ? broker.unanswered + 1 : 0;
    Next next{advance(end.version_refused, random), std::nullopt};
    // A version below which there is another is not a failure of interest to anybody.
    if (end.version_refused && version_ == Version::kBest) return next;
    auto failure = end.failure;
    // A broker that misses our certificate reports it in an alert, which its closing of the socket often
    // overtakes.
    if (failure.broker.tls && broker.unanswered >= kUnansweredUntilTls)
        failure.kind = ConnectionFailure::Kind::kTls;
    broker.failed_fatally = failure.fatal();
    failure.hopeless = hopeless();
    next.failure = std::move(failure);
    return next;
}

Duration BrokerList::advance(bool same_broker_at_once, const Random& random) {
    if (!same_broker_at_once && !brokers_[current_].version.suspected()) {
        current_ = (current_ + 1) % brokers_.size();
        closed_soon_ = 0;
    }
    // The whole list is tried without waiting, then there is a pause.
    if (++failures_this_round_ < brokers_.size()) return {};
    failures_this_round_ = 0;
    return backoff_.next(random);
}

bool BrokerList::hopeless() const {
    return !ever_accepted_ && std::all_of(brokers_.begin(), brokers_.end(),
                                          [](const Broker& each) { return each.failed_fatally; });
}

}  // namespace asip::mqtt
