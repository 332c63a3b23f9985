// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/shares.hpp"

#include <algorithm>
#include <ctime>

namespace asip::bus {

namespace {

Duration time_of(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

std::size_t bytes_of(const mqtt::Message& message) {
    return message.topic.size() + message.payload.size() + BoardShares::kAround;
}

}  // namespace

Shares::Place Shares::place_of(const Accounts::value_type& account) {
    const bool first = !account.second.urgent.empty() && account.second.used_urgently < kUrgent;
    return {!first, account.second.used, &account.first};
}

// The thread's own clock takes a system call. Between two looks at it, time that passes stands for it: no
// thread uses more.
Duration Shares::processor_time() {
    struct Look {
        Duration at = -kBetweenLooks, used{}, told{};
    };
    static thread_local Look look;
    const auto now = time_of(CLOCK_MONOTONIC_RAW);
    if (now - look.at >= kBetweenLooks) look = {now, time_of(CLOCK_THREAD_CPUTIME_ID), look.told};
    look.told = std::max(look.told, look.used + (now - look.at));
    return look.told;
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

Duration Shares::step(Duration began) {
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
    const bool more = job();
    if (!more) job = {};  // what it holds ends in its own turn
    const auto ended = clock_();
    account.used += ended - began;
    if (urgent) account.used_urgently += ended - began;
    running_ = nullptr;
    if (more) jobs.push_front(std::move(job));
    if (!account.urgent.empty() || !account.others.empty()) waiting_.insert(place_of(*found));
    return ended;
}

bool Shares::run() {
    if (waiting_.empty()) return false;
    auto time = clock_();
    const auto until = time + kSlice;
    do
        time = step(time);
    while (!waiting_.empty() && time < until);
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

void BoardShares::refill(Board& board, Time now) {
    board.left = std::min(kBurst, board.left + (now - board.at) / kPart);
    board.at = now;
}

void BoardShares::message(std::string_view name, const mqtt::Message& message, Time now) {
    auto found = boards_.find(name);
    if (found == boards_.end())
        found = boards_.try_emplace(std::string(name), Board{kBurst, now, {}, 0}).first;
    auto& board = found->second;
    refill(board, now);
    if (board.left <= Duration{} || !board.waiting.empty()) return wait(*found, message);
    const auto began = shares_.now();
    handle_(message);
    board.left -= shares_.now() - began;
}

// What is left has the order in which it came.
void BoardShares::wait(Boards::value_type& of, const mqtt::Message& message) {
    auto& board = of.second;
    const bool first = board.waiting.empty();
    const auto older = std::find_if(board.waiting.begin(), board.waiting.end(),
                                    [&](const auto& each) { return each.topic == message.topic; });
    if (older != board.waiting.end()) drop(board, older);
    board.waiting.push_back(message);
    board.bytes += bytes_of(message);
    while (board.bytes > kMaxBytes && board.waiting.size() > 1)
        drop(board, board.waiting.begin());
    if (first) shares_.add("board " + of.first, [this, name = of.first] { return next(name); });
}

void BoardShares::drop(Board& board, std::list<mqtt::Message>::iterator which) {
    replaced_(which->topic);
    board.bytes -= bytes_of(*which);
    board.waiting.erase(which);
}

bool BoardShares::next(const std::string& name) {
    const auto found = boards_.find(name);
    if (found == boards_.end() || found->second.waiting.empty()) return false;
    auto& board = found->second;
    const auto message = std::move(board.waiting.front());
    board.waiting.pop_front();
    board.bytes -= bytes_of(message);
    const auto began = shares_.now();
    handle_(message);
    board.left -= shares_.now() - began;
    return !board.waiting.empty();
}

void BoardShares::disconnected() {
    for (auto& [name, board] : boards_) {
        board.waiting.clear();
        board.bytes = 0;
    }
}

void BoardShares::tick(Time now) {
    for (auto each = boards_.begin(); each != boards_.end();) {
        auto& board = each->second;
        refill(board, now);
        each = board.waiting.empty() && board.left == kBurst ? boards_.erase(each) : std::next(each);
    }
}

}  // namespace asip::bus
