// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/exhaustive/pairs.hpp"

#include <utility>

namespace truth {

namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 28;

bool same_byte(const Faults& a, const Faults& b) {
    const auto same = [](const std::vector<ByteFault>& one, const std::vector<ByteFault>& other) {
        return !one.empty() && !other.empty() && one[0].byte == other[0].byte;
    };
    return same(a.to_board, b.to_board) || same(a.to_host, b.to_host);
}

}  // namespace

Faults both(const Faults& first, const Faults& second) {
    Faults both = first;
    both.to_board.insert(both.to_board.end(), second.to_board.begin(), second.to_board.end());
    both.to_host.insert(both.to_host.end(), second.to_host.begin(), second.to_host.end());
    both.incidents.insert(both.incidents.end(), second.incidents.begin(), second.incidents.end());
    return both;
}

Pairs::Pairs(Undisturbed& undisturbed, const std::vector<Faults>& faults, Played played)
    : undisturbed_(undisturbed), faults_(faults), played_(std::move(played)), after_first_(kMaxBytes) {
    const auto trial = [&] {
        return std::make_unique<Trial>(undisturbed.scenario(), Faults{}, undisturbed.end().times, false);
    };
    lead_ = trial();
    before_ = trial();
    trial_ = trial();
    for (std::size_t number = 0; number < faults.size(); ++number) {
        const Faults& fault = faults[number];
        steps_.push_back(undisturbed.step_of(fault));
        for (const auto& byte : fault.to_board)
            to_board_[byte.byte].push_back(number);
        for (const auto& byte : fault.to_host)
            to_host_[byte.byte].push_back(number);
        for (const auto& incident : fault.incidents)
            incidents_.emplace(incident.at, number);
    }
}

Pairs::Count Pairs::run() {
    const std::uint64_t faults = faults_.size();
    count_.pairs = faults * (faults - 1) / 2;
    for (std::size_t first = 0; first < faults_.size(); ++first)
        if (!all_behind(first)) break;
    return count_;
}

// The first fault comes; at each step behind it, each second one that may come there.
bool Pairs::all_behind(std::size_t first) {
    const auto& end = undisturbed_.end();
    std::unique_ptr<const Firmware::Saved> saved;
    From from{};
    Range sent;
    Micros time = -1;
    if (steps_[first] == Undisturbed::kPowerUp) {
        lead_ = std::make_unique<Trial>(undisturbed_.scenario(), faults_[first], end.times, false);
        lead_->power_up();
    } else {
        const auto& step = undisturbed_.steps()[steps_[first]];
        from = {step.before.get(), step.firmware.get()};
        sent = step.before->sent();
        time = step.before->now();
        lead_->resume(*step.before, *step.firmware, faults_[first]);
        lead_->pass_on();
    }
    for (bool same_step = true;; same_step = false) {
        auto here = lead_->firmware().save();
        if (!each_since(sent, time, from, first, same_step)) return false;
        lead_->firmware().put_back(*here);
        sent = lead_->sent();
        time = lead_->now();
        if (sent.from >= end.to_board.until && sent.until >= end.to_host.until && time >= end.times.last)
            return true;
        if (!after_first_.add(lead_->state_and_place(), {})) return true;
        before_->resume(*lead_, *here, faults_[first]);
        saved = std::move(here);
        from = {before_.get(), saved.get()};
        if (!lead_->pass_on()) return true;
    }
}

// Those that come in the step of the lead that began there. In the step of the first fault, only those that
// do not have their turn as the first with this one as the second.
bool Pairs::each_since(const Range& sent, Micros time, const From& from, std::size_t first, bool same_step) {
    const auto play_one = [&](std::size_t second) {
        if (same_step &&
            (steps_[second] == steps_[first] ? second <= first : steps_[second] + 1 < steps_[first] + 1))
            return true;
        return same_byte(faults_[first], faults_[second]) || play(from, first, second);
    };
    const auto play_all = [&](const auto& numbers, std::uint64_t begin, std::uint64_t end) {
        for (auto at = numbers.lower_bound(begin); at != numbers.end() && at->first < end; ++at)
            for (const std::size_t second : at->second)
                if (!play_one(second)) return false;
        return true;
    };
    if (!play_all(to_board_, sent.from, lead_->sent().from)) return false;
    if (!play_all(to_host_, sent.until, lead_->sent().until)) return false;
    for (auto at = incidents_.upper_bound(time); at != incidents_.end() && at->first <= lead_->now(); ++at)
        if (!play_one(at->second)) return false;
    return true;
}

bool Pairs::play(const From& from, std::size_t first, std::size_t second) {
    const auto faults = both(faults_[first], faults_[second]);
    std::unique_ptr<Trial> fresh;
    if (from.trial == nullptr) {
        fresh = std::make_unique<Trial>(undisturbed_.scenario(), faults, undisturbed_.end().times, false);
        fresh->power_up();
    } else {
        trial_->resume(*from.trial, *from.firmware, faults);
    }
    auto end = (fresh ? *fresh : *trial_).go_on(&undisturbed_.known());
    ++count_.played;
    if (end.equal_state) ++count_.equal;
    count_.counts.add(end.counts);
    return played_(first, second, end);
}

}  // namespace truth
