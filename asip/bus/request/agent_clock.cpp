// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/agent_clock.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>

namespace asip::bus {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kAgentDigits = 8;
constexpr std::int64_t kMaxMilliseconds = 4'000'000'000'000;  // in nanoseconds still a Time: 126 years
constexpr milliseconds kResolution{1};

struct Reading {
    std::string_view agent;
    milliseconds at;
};

std::optional<Reading> parse(std::string_view text) {
    if (text.size() < kAgentDigits + 2 || text[kAgentDigits] != '-') return std::nullopt;
    std::int64_t at = -1;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + kAgentDigits + 1, end, at);
    if (error != std::errc() || rest != end || at < 0 || at > kMaxMilliseconds) return std::nullopt;
    return Reading{text.substr(0, kAgentDigits), milliseconds(at)};
}

std::string text_of(std::string_view agent, Duration at) {
    return std::string(agent) + "-" + std::to_string(std::chrono::floor<milliseconds>(at).count());
}

}  // namespace

std::string AgentClock::read(Time now) const {
    return text_of(agent_, now.time_since_epoch());
}

std::optional<Time> AgentClock::time_of(std::string_view reading) const {
    const auto read = parse(reading);
    if (!read || read->agent != agent_) return std::nullopt;
    return Time(read->at + kResolution);
}

void AgentClocks::note(const std::string& of, std::string_view reading, Time asked, Time answered) {
    const auto read = parse(reading);
    if (!read) return;
    const Duration most = read->at + kResolution - asked.time_since_epoch();
    const Duration least = read->at - answered.time_since_epoch();
    if (known_.size() >= kMax && !known_.contains(of)) known_.clear();
    const auto [entry, is_new] = known_.try_emplace(of, Known{std::string(read->agent), most});
    Known& known = entry->second;
    // Less than the least: one of the two machines was suspended, or their clocks go at different rates.
    if (is_new || known.agent != read->agent || known.ahead < least)
        known = {std::string(read->agent), most};
    else
        known.ahead = std::min(known.ahead, most);
}

std::string AgentClocks::reading(const std::string& of, Time now) const {
    const auto known = known_.find(of);
    if (known == known_.end()) return {};
    const Duration at = now.time_since_epoch() + known->second.ahead;
    return at < Duration::zero() ? std::string() : text_of(known->second.agent, at);
}

}  // namespace asip::bus
