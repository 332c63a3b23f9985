// SPDX-License-Identifier: Apache-2.0
// Boards of ASIP 0.4 stop reporting when their 16-bit clock wraps, each 65.5 s, until a period is set anew.
#include <algorithm>
#include <utility>

#include "asip/session/machine.hpp"

namespace asip::session {

namespace {

// Behind a report, so that the next one is not put off: well before the clock wraps.
constexpr Duration kRenewAfter = std::chrono::seconds(30);
// How long beyond two periods a report may be missing.
constexpr Duration kFirstPatience = std::chrono::milliseconds(500);
constexpr Duration kLongestPatience = std::chrono::seconds(60);

}  // namespace

void Machine::note_renewed(char service) {
    if (!identity_.extensions.empty() || service == '#') return;
    auto& renewal = renewals_[service];
    renewal.asked = last_byte_;
    renewal.pending = false;
    renewal.patience = std::max(renewal.patience, kFirstPatience);
}

void Machine::renew_behind(char service, Time now) {
    const auto known = renewals_.find(service);
    if (known == renewals_.end()) return;
    known->second.reported = now;
    known->second.patience = kFirstPatience;
    const auto period = settings_.period(service);
    if (period && *period > 0 && now >= known->second.asked + kRenewAfter) renew(service, known->second);
}

void Machine::renew(char service, Renewal& renewal) {
    if (std::exchange(renewal.pending, true)) return;
    Request request;
    request.line = std::string{service, ','} + "A," + std::to_string(*settings_.period(service));
    queue_.waiting().push_own(std::move(request));
}

Time Machine::missing_at(char service, const Renewal& renewal) const {
    const auto period = settings_.period(service);
    if (!period || *period == 0 || renewal.pending) return Time::max();
    return std::max(renewal.asked, renewal.reported) + 2 * std::chrono::milliseconds(*period) +
           renewal.patience;
}

void Machine::renew_missing(Time now) {
    for (auto& [service, renewal] : renewals_) {
        if (now < missing_at(service, renewal)) continue;
        renewal.patience = std::min(renewal.patience * 2, kLongestPatience);
        renew(service, renewal);
    }
}

Time Machine::next_renewal() const {
    Time next = Time::max();
    for (const auto& [service, renewal] : renewals_)
        next = std::min(next, missing_at(service, renewal));
    return next;
}

}  // namespace asip::session
