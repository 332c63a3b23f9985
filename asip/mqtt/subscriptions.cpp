// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/subscriptions.hpp"

#include <algorithm>

namespace asip::mqtt {

void Subscriptions::add(const std::string& filter, SubscribeOptions options) {
    Wanted wanted;
    wanted.options = options;
    wanted_.insert_or_assign(filter, std::move(wanted));
}

void Subscriptions::restart() {
    unanswered_.clear();
    for (auto& [filter, wanted] : wanted_) {
        wanted.state = State::kDue;
        wanted.refusals = 0;
        wanted.backoff.reset();
    }
}

std::vector<Subscriptions::Sending> Subscriptions::due(Time now) const {
    std::vector<Sending> result;
    for (const auto& [filter, wanted] : wanted_) {
        const bool again = wanted.state == State::kRefused && now >= wanted.again;
        if (wanted.state == State::kDue || again) result.emplace_back(filter, wanted.options);
    }
    return result;
}

void Subscriptions::sent(int id, const std::string& filter, Time now) {
    const auto found = wanted_.find(filter);
    if (found == wanted_.end()) return;
    found->second.state = State::kSent;
    unanswered_[id] = {filter, now};
}

std::optional<Subscriptions::Refusal> Subscriptions::answered(int id, bool granted, Time now,
                                                              const Random& random) {
    const auto packet = unanswered_.find(id);
    if (packet == unanswered_.end()) return std::nullopt;
    const auto filter = std::move(packet->second.filter);
    unanswered_.erase(packet);
    const auto found = wanted_.find(filter);
    if (found == wanted_.end() || found->second.state != State::kSent) return std::nullopt;
    auto& wanted = found->second;
    if (granted) {
        wanted.state = State::kGranted;
        wanted.refusals = 0;
        return std::nullopt;
    }
    wanted.state = State::kRefused;
    wanted.again = now + wanted.backoff.next(random);
    ++wanted.refusals;
    return Refusal{filter, wanted.refusals == 1, wanted.options.required && wanted.refusals == kMaxRefusals};
}

bool Subscriptions::all_granted() const {
    return std::all_of(wanted_.begin(), wanted_.end(),
                       [](const auto& one) { return one.second.state == State::kGranted; });
}

std::optional<Time> Subscriptions::waiting_since() const {
    std::optional<Time> oldest;
    for (const auto& [id, packet] : unanswered_) {
        if (!oldest || packet.at < *oldest) oldest = packet.at;
    }
    return oldest;
}

}  // namespace asip::mqtt
