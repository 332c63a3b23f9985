// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/shares.hpp"

#include <algorithm>
#include <ctime>

namespace asip::bus {

Shares::Place Shares::place_of(const Accounts::value_type& account) {
    return {account.second.urgent.empty(), account.second.used, &account.first};
}

Duration Shares::processor_time() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

void Shares::add(const std::string& name, Job job, bool urgent) {
    const bool idle = waiting_.empty() && running_ == nullptr;
    const auto found = accounts_.try_emplace(name).first;
    auto& account = found->second;
    const bool runs = running_ == &*found;
    if (!runs && waiting_.erase(place_of(*found)) == 0) account.used = std::max(account.used, least_);
    (urgent ? account.urgent : account.others).push_back(std::move(job));
    if (!runs) waiting_.insert(place_of(*found));
    if (idle) wake_();
}

void Shares::step() {
    const auto* name = std::get<const std::string*>(*waiting_.begin());
    const auto found = accounts_.find(*name);
    waiting_.erase(waiting_.begin());
    auto& account = found->second;
    least_ = std::max(least_, account.used);
    const bool urgent = !account.urgent.empty();
    auto& jobs = urgent ? account.urgent : account.others;
    auto job = std::move(jobs.front());
    jobs.pop_front();
    running_ = &*found;
    const auto began = clock_();
    const bool more = job();
    if (!more) job = {};  // what it holds ends in its own turn
    account.used += clock_() - began;
    running_ = nullptr;
    if (more) jobs.push_front(std::move(job));
    if (!account.urgent.empty() || !account.others.empty()) waiting_.insert(place_of(*found));
}

bool Shares::run() {
    if (waiting_.empty()) return false;
    const auto until = clock_() + kSlice;
    do
        step();
    while (!waiting_.empty() && clock_() < until);
    if (waiting_.empty()) {
        accounts_.clear();
        least_ = {};
    } else {
        std::erase_if(accounts_, [this](const auto& each) {
            return each.second.used <= least_ && each.second.urgent.empty() && each.second.others.empty();
        });
    }
    return !waiting_.empty();
}

}  // namespace asip::bus
