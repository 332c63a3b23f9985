#include "agent/recent_answers.hpp"

namespace asip::agent {

RecentAnswers::Seen RecentAnswers::see(const std::string& key, Time now) {
    forget_old(now);
    const auto [it, is_new] = entries_.try_emplace(key);
    if (!is_new) return it->second ? Seen::kAnswered : Seen::kPending;
    order_.emplace_back(now, key);
    return Seen::kNew;
}

void RecentAnswers::answer(const std::string& key, bus::Reply reply) {
    const auto it = entries_.find(key);
    if (it != entries_.end()) it->second = std::move(reply);
}

const bus::Reply* RecentAnswers::find(const std::string& key) const {
    const auto it = entries_.find(key);
    return it == entries_.end() || !it->second ? nullptr : &*it->second;
}

void RecentAnswers::forget_old(Time now) {
    while (!order_.empty() && (order_.front().first + kKept < now || order_.size() >= kMost)) {
        entries_.erase(order_.front().second);
        order_.pop_front();
    }
}

}  // namespace asip::agent
