// SPDX-License-Identifier: Apache-2.0
#include "agent/safety/holds.hpp"

#include <algorithm>
#include <utility>

namespace asip::agent {

bool Holds::room_for(std::string_view safe) const {
    return holds_.size() < kMax || holds_.contains(safe);
}

void Holds::begin(Hold hold) {
    const auto known = holds_.find(hold.safe);
    Entry entry{std::move(hold), false, known != holds_.end()};
    std::string safe = entry.hold.safe;
    holds_.insert_or_assign(std::move(safe), std::move(entry));
}

std::size_t Holds::renew(session::ClientId client, std::string_view service,
                         std::optional<std::string_view> id, std::optional<Duration> length, Time at) {
    std::size_t count = 0;
    for (auto& [safe, entry] : holds_) {
        Hold& hold = entry.hold;
        if (hold.client != client || hold.service != service || (id && hold.id != *id)) continue;
        const Time from = std::max(at, hold.ends - hold.length);
        hold.length = length.value_or(hold.length);
        hold.ends = from + hold.length;
        ++count;
    }
    return count;
}

void Holds::on_finished(const session::Finished& end, std::string_view safe) {
    using session::Ending;
    const auto found = holds_.find(safe);
    if (found == holds_.end()) return;
    Entry& entry = found->second;
    const bool executed =
        end.ending == Ending::kExecuted || end.ending == Ending::kUnproven || end.ending == Ending::kNoValue;
    if (end.id != entry.hold.request) {
        // What is still on its way may be executed after this one: then it is not over yet.
        if (executed && entry.in_force) holds_.erase(found);
        return;
    }
    if (executed) entry.in_force = true;
    const bool not_executed = end.ending == Ending::kNotSent || end.ending == Ending::kBoardError;
    if (not_executed && !entry.maybe_before) holds_.erase(found);
}

std::vector<Holds::Hold> Holds::take_expired(Time now) {
    std::vector<Hold> expired;
    for (auto it = holds_.begin(); it != holds_.end();) {
        if (now < it->second.hold.ends) {
            ++it;
            continue;
        }
        expired.push_back(std::move(it->second.hold));
        it = holds_.erase(it);
    }
    return expired;
}

std::vector<Holds::Hold> Holds::take_all() {
    std::vector<Hold> all;
    for (auto& [safe, entry] : std::exchange(holds_, {}))
        all.push_back(std::move(entry.hold));
    return all;
}

std::optional<Time> Holds::next_deadline() const {
    std::optional<Time> first;
    for (const auto& [safe, entry] : holds_)
        if (!first || entry.hold.ends < *first) first = entry.hold.ends;
    return first;
}

}  // namespace asip::agent
