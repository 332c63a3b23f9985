// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/subscriptions.hpp"

#include <algorithm>

namespace asip::mqtt {

void Subscriptions::add(const std::string& filter, SubscribeOptions options) {
    remove(filter);
    auto& wanted = wanted_[filter];
    wanted.options = options;
    count(wanted, 1);
    group_of(wanted).open.insert(filter);
}

void Subscriptions::remove(const std::string& filter) {
    const auto found = wanted_.find(filter);
    if (found == wanted_.end()) return;
    count(found->second, -1);
    group_of(found->second).open.erase(filter);
    wanted_.erase(found);
}

void Subscriptions::count(const Wanted& wanted, std::ptrdiff_t by) {
    const auto add = [by](std::size_t& to) { to += static_cast<std::size_t>(by); };
    Group& group = group_of(wanted);
    add(group.wanted);
    if (wanted.state == State::kGranted)
        add(group.granted);
    else if (wanted.state != State::kRefused)
        add(group.unanswered);
}

void Subscriptions::set(Wanted& wanted, const std::string& filter, State state) {
    count(wanted, -1);
    wanted.state = state;
    count(wanted, 1);
    if (state == State::kDue || state == State::kRefused)
        group_of(wanted).open.insert(filter);
    else
        group_of(wanted).open.erase(filter);
}

void Subscriptions::restart(bool defers) {
    unanswered_.clear();
    defers_ = defers;
    others_from_ = {};
    for (auto& [filter, wanted] : wanted_) {
        set(wanted, filter, State::kDue);
        wanted.refusals = 0;
        wanted.backoff.reset();
    }
}

std::vector<Subscriptions::Sending> Subscriptions::due(Time now) const {
    std::vector<Sending> result;
    add_due(required_, now, result);
    if (!holds_back(now)) add_due(others_, now, result);
    return result;
}

void Subscriptions::add_due(const Group& group, Time now, std::vector<Sending>& result) const {
    for (const auto& filter : group.open) {
        const auto& wanted = wanted_.at(filter);
        if (wanted.state != State::kDue && now < wanted.again) continue;
        result.emplace_back(filter, wanted.options);
        if (wanted.refusals > 0) result.back().second.qos = 0;
    }
}

void Subscriptions::sent(int id, const std::string& filter, Time now) {
    const auto found = wanted_.find(filter);
    if (found == wanted_.end()) return;
    set(found->second, filter, State::kSent);
    unanswered_[id] = {filter, now};
}

std::optional<Subscriptions::Refusal> Subscriptions::answered(int id, bool granted, Time now,
                                                              const Random& random) {
    const auto packet = unanswered_.find(id);
    if (packet == unanswered_.end()) return std::nullopt;
    const auto filter = std::move(packet->second.filter);
    const auto after = now - packet->second.at;
    unanswered_.erase(packet);
    const auto found = wanted_.find(filter);
    if (found == wanted_.end() || found->second.state != State::kSent) return std::nullopt;
    auto& wanted = found->second;
    if (granted) {
        set(wanted, filter, State::kGranted);
        wanted.refusals = 0;
        if (defers_ && wanted.options.required && required_.all_granted() && after >= kBusy)
            others_from_ = now + std::min(after, kMostDeference);
        return std::nullopt;
    }
    set(wanted, filter, State::kRefused);
    wanted.again = now + wanted.backoff.next(random);
    ++wanted.refusals;
    return Refusal{filter, wanted.refusals == 1, wanted.options.required && wanted.refusals == kMaxRefusals,
                   after};
}

std::optional<Time> Subscriptions::waiting_since() const {
    std::optional<Time> oldest;
    for (const auto& [id, packet] : unanswered_) {
        if (!oldest || packet.at < *oldest) oldest = packet.at;
    }
    return oldest;
}

}  // namespace asip::mqtt
