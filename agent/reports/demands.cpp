// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/demands.hpp"

#include <algorithm>

#include "asip/bus/pattern.hpp"

namespace asip::agent {
namespace {

std::string user_of(std::string_view demander) {
    return std::string(demander.substr(0, demander.find('/')));
}

}  // namespace

void Demands::erase(Entries::iterator entry) {
    const auto user = users_.find(user_of(entry->first));
    if (--user->second == 0) users_.erase(user);
    entries_.erase(entry);
}

// The one that would end first, of the user with most, goes.
bool Demands::make_room(const std::string& user) {
    if (entries_.size() < kMax) return true;
    const auto most = std::max_element(users_.begin(), users_.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    const auto own = users_.find(user);
    if (own != users_.end() && own->second + 1 >= most->second) return false;
    auto first = entries_.end();
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
        if (user_of(entry->first) != most->first) continue;
        if (first == entries_.end() || entry->second.until < first->second.until) first = entry;
    }
    erase(first);
    return true;
}

bool Demands::take(std::string_view demander, bus::Demand demand, Time now) {
    auto known = entries_.find(demander);
    if (demand.services.empty()) {
        if (known == entries_.end()) return true;
        known->second.until = std::min(known->second.until, now + kLinger);
        earliest_ = std::min(earliest_, known->second.until);
        return true;
    }
    if (known == entries_.end()) {
        const auto user = user_of(demander);
        if (!make_room(user)) return false;
        ++users_[user];
        known = entries_.emplace(std::string(demander), Entry{}).first;
    }
    known->second = {std::move(demand.services), now + demand.lease + kLinger};
    earliest_ = std::min(earliest_, known->second.until);
    return true;
}

double Demands::hz(std::string_view service, char letter) const {
    double most = 0;
    for (const auto& [demander, entry] : entries_) {
        for (const auto& [pattern, hz] : entry.services)
            if (hz > most &&
                (bus::matches_pattern(pattern, service) || pattern == std::string_view(&letter, 1)))
                most = hz;
    }
    return most;
}

bool Demands::expire(Time now) {
    if (now < earliest_) return false;
    const auto before = entries_.size();
    earliest_ = Time::max();
    for (auto entry = entries_.begin(); entry != entries_.end();) {
        const auto each = entry++;
        if (each->second.until <= now)
            erase(each);
        else
            earliest_ = std::min(earliest_, each->second.until);
    }
    return entries_.size() != before;
}

std::optional<Time> Demands::next_deadline() const {
    if (entries_.empty()) return std::nullopt;
    return earliest_;
}

}  // namespace asip::agent
