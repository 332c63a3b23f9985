// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/exhaustive/undisturbed.hpp"

#include <algorithm>
#include <utility>

namespace truth {

namespace {

bool is_before(const Trial& trial, const Faults& faults) {
    const auto sent = trial.sent();
    const auto later = [](std::uint64_t next) {
        return [next](const ByteFault& fault) { return fault.byte >= next; };
    };
    return std::all_of(faults.to_board.begin(), faults.to_board.end(), later(sent.from)) &&
           std::all_of(faults.to_host.begin(), faults.to_host.end(), later(sent.until)) &&
           std::all_of(faults.incidents.begin(), faults.incidents.end(),
                       [&](const Incident& incident) { return incident.at > trial.now(); });
}

}  // namespace

Undisturbed::Undisturbed(const Scenario& scenario)
    : scenario_(scenario), end_(run_trial(scenario, {}, {}, false)) {
    if (!end_.failure.empty()) return;
    trial_ = std::make_unique<Trial>(scenario, Faults{}, end_.times, false);
    Trial calm(scenario, {}, end_.times, false);
    calm.power_up();
    do {
        const auto sent = calm.sent();
        const bool near = scenario.from != Scenario::From::kReady || calm.now() + kQuiet >= end_.times.ready;
        if (!near || sent.from > end_.to_board.until || sent.until > end_.to_host.until) continue;
        auto before = std::make_unique<Trial>(scenario, Faults{}, end_.times, false);
        auto firmware = calm.firmware().save();
        before->resume(calm, *firmware, {});
        steps_.push_back({std::move(before), std::move(firmware)});
    } while (calm.now() < end_.times.last && calm.pass_on());
}

std::size_t Undisturbed::step_of(const Faults& faults) const {
    const auto after = std::partition_point(
        steps_.begin(), steps_.end(), [&](const Step& step) { return is_before(*step.before, faults); });
    return static_cast<std::size_t>(after - steps_.begin()) - 1;
}

TrialEnd Undisturbed::run(const Faults& faults) {
    const auto number = step_of(faults);
    if (number == kPowerUp) {
        Trial trial(scenario_, faults, end_.times, false);
        trial.power_up();
        return trial.go_on();
    }
    const Step& step = steps_[number];
    trial_->resume(*step.before, *step.firmware, faults);
    return trial_->go_on();
}

}  // namespace truth
