// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/subscriptions.hpp"

namespace asip::mqtt {

void Subscriptions::add(const std::string& filter, SubscribeOptions options) {
    remove(filter);
    auto& wanted = wanted_[filter];
    wanted.options = options;
    ++group_of(wanted).wanted;
    group_of(wanted).open.insert(filter);
}

void Subscriptions::remove(const std::string& filter) {
    const auto found = wanted_.find(filter);
    if (found == wanted_.end()) return;
    set(found->second, filter, State::kDue);
    --group_of(found->second).wanted;
    group_of(found->second).open.erase(filter);
    wanted_.erase(found);
}

void Subscriptions::set(Wanted& wanted, const std::string& filter, State state) {
    Group& group = group_of(wanted);
    if (wanted.state == State::kGranted) --group.granted;
    if (state == State::kGranted) ++group.granted;
    wanted.state = state;
    if (state == State::kDue || state == State::kRefused)
        group.open.insert(filter);
    else
        group.open.erase(filter);
}

void Subscriptions::restart() {
    unanswered_.clear();
    for (auto& [filter, wanted] : wanted_) {
        set(wanted, filter, State::kDue);
        wanted.refusals = 0;
        wanted.backoff.reset();
    }
}

std::vector<Subscriptions::Due> Subscriptions::take_due(Time now) {
    std::vector<Due> result;
    take_due(required_, now, result);
    take_due(optional_, now, result);
    return result;
}

void Subscriptions::take_due(Group& group, Time now, std::vector<Due>& result) {
    const auto first = result.size();
    for (const auto& filter : group.open) {
        const auto& wanted = wanted_.at(filter);
        if (wanted.state == State::kDue || now >= wanted.again)
            result.push_back({filter, wanted.options, wanted.refusals > 0});
    }
    for (auto i = first; i < result.size(); ++i)
        set(wanted_.at(result[i].filter), result[i].filter, State::kSent);
}

void Subscriptions::sent(int id, const std::string& filter, Time now) {
    unanswered_[id] = {filter, now};
}

void Subscriptions::not_sent(const std::string& filter) {
    const auto found = wanted_.find(filter);
    if (found != wanted_.end() && found->second.state == State::kSent)
        set(found->second, filter, State::kDue);
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
        set(wanted, filter, State::kGranted);
        wanted.refusals = 0;
        return std::nullopt;
    }
    set(wanted, filter, State::kRefused);
    wanted.again = now + wanted.backoff.next(random);
    ++wanted.refusals;
    return Refusal{filter, wanted.refusals == 1, wanted.options.required && wanted.refusals == kMaxRefusals};
}

std::optional<Time> Subscriptions::waiting_since() const {
    std::optional<Time> oldest;
    for (const auto& [id, packet] : unanswered_)
        if (!oldest || packet.at < *oldest) oldest = packet.at;
    return oldest;
}

}  // namespace asip::mqtt
