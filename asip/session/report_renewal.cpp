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
// Sketches may set a period themselves: it is measured between so many reports.
constexpr int kGaps = 16;
constexpr Duration kLongestGap = std::chrono::seconds(1);
// Reports that follow each other faster have waited on the way: in the port while no program read it, or
// while this one was not run. Their gaps say nothing of the board.
constexpr Duration kShortestGap = std::chrono::milliseconds(2);
constexpr std::chrono::milliseconds kRound(5);

}  // namespace

void Machine::note_renewed(char service) {
    if (!identity_.extensions.empty() || service == '#') return;
    auto& renewal = renewals_[service];
    renewal.asked = last_byte_;
    renewal.pending = false;
    renewal.patience = std::max(renewal.patience, kFirstPatience);
}

void Machine::renew_behind(const protocol::Event& event, Time now) {
    const auto period = settings_.period(event.service);
    if (!period) return note_unasked(event, now);
    const auto known = renewals_.find(event.service);
    if (known == renewals_.end()) return;
    known->second.reported = now;
    known->second.patience = kFirstPatience;
    if (*period > 0 && now >= known->second.asked + kRenewAfter) renew(event.service, known->second);
}

// A board of ASIP 0.4 reports its analog pins from its start on, at a period that it does not tell.
void Machine::note_unasked(const protocol::Event& event, Time now) {
    if (!identity_.extensions.empty() || event.service != 'I' || event.tag != 'a') return;
    auto& renewal = renewals_[event.service];
    const Duration gap = now - std::exchange(renewal.reported, now);
    renewal.patience = kFirstPatience;
    if (gap > kLongestGap || gap < kShortestGap) {
        renewal.gaps = 0;
        return;
    }
    renewal.gap = renewal.gaps == 0 ? gap : renewal.gap + (gap - renewal.gap) / (renewal.gaps + 1);
    if (++renewal.gaps < kGaps) return;
    const auto rounds = std::max<Duration::rep>((renewal.gap + kRound / 2) / kRound, 1);
    renewal.measured = static_cast<unsigned>((rounds * kRound).count());
    renewal.gaps = 0;
}

std::optional<unsigned> Machine::renewed_period(char service, const Renewal& renewal) const {
    if (const auto set = settings_.period(service)) return set;
    return renewal.measured;
}

void Machine::renew(char service, Renewal& renewal) {
    if (std::exchange(renewal.pending, true)) return;
    Request request;
    request.line = std::string{service, ','} + "A," + std::to_string(*renewed_period(service, renewal));
    queue_.waiting().push_own(std::move(request));
}

Time Machine::missing_at(char service, const Renewal& renewal) const {
    const auto period = renewed_period(service, renewal);
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
