// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/exhaustive/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "tests/truth/world.hpp"

namespace truth {

namespace {

using State = asip::session::BoardSession::State;

// What a command that comes when all is well again has executed.
constexpr int kLastMark = 900;
constexpr int kLastCommands = 2;
constexpr unsigned kLastClient = 9;

Plan plan_of(const Scenario& scenario, const Faults& faults) {
    Plan plan = scenario.plan;
    plan.to_board.faults = faults.to_board;
    plan.to_host.faults = faults.to_host;
    return plan;
}

}  // namespace

Trial::Trial(const Scenario& scenario, const Faults& faults, Times times, bool trace)
    : World(setting_of(scenario, faults, times, trace)), scenario_(scenario), undisturbed_(times.ready == 0) {
    incidents_ = faults.incidents;
    end_.times = times;
}

World::Setting Trial::setting_of(const Scenario& scenario, const Faults& faults, Times times, bool trace) {
    auto plan = plan_of(scenario, faults);
    const bool calm = times.ready == 0 && plan.incidents.empty();
    return {Dice(1), std::move(plan), calm, trace};
}

void Trial::on_fault(const WireByte& byte) {
    faults_end_ = std::max({faults_end_, now_, byte.arrives});
}

void Trial::on_read(const BoardRead& read) {
    for (const Effect& effect : read.effects)
        if (effect.kind == Effect::Kind::kMode)
            modes_[effect.subject] = effect.value;
        else if (effect.kind == Effect::Kind::kLevel)
            levels_[effect.subject] = effect.value;
    if (scenario_.from == Scenario::From::kRate && !rate_asked_ && read.text.starts_with("#,B,")) {
        rate_asked_ = true;
        end_.to_board.from = to_board_.sent() - read.text.size() - 1;
        end_.to_host.from = to_host_.sent();
    }
}

void Trial::on_board_off() {
    off_at_ = now_;
    modes_.clear();
    levels_.clear();
}

void Trial::on_incident(const Incident& incident) {
    faults_end_ = std::max(faults_end_, now_ + incident.lasts + plan_.boot);
}

Micros Trial::next_step() const {
    if (next_step_ == scenario_.steps.size() || end_.times.ready == 0) return last_at_;
    return std::min(last_at_, end_.times.ready + scenario_.steps[next_step_].after);
}

// The scenario's own incidents come so long after the board was ready, as its steps do.
void Trial::begin() {
    for (Incident incident : plan_.incidents) {
        incident.at += end_.times.ready;
        incidents_.push_back(incident);
    }
    std::sort(incidents_.begin(), incidents_.end(),
              [](const Incident& a, const Incident& b) { return a.at < b.at; });
}

void Trial::steps() {
    if (end_.times.ready == 0) return;
    while (next_step_ < scenario_.steps.size() &&
           end_.times.ready + scenario_.steps[next_step_].after <= now_)
        step(scenario_.steps[next_step_++]);
}

void Trial::step(const Step& step) {
    if (step.renews ? agent_.renew(step.command.client, now_) : step.command.hold > 0) held_from_ = now_;
    if (!step.renews) agent_.submit(step.command, now_);
}

// The range of bytes and moments in which faults are tried.
void Trial::watch() {
    if (!ready_ && agent_.state() == State::kReady) {
        ready_ = true;
        if (undisturbed_) {
            end_.times.ready = now_ + kQuiet;
            begin();
        }
    }
    if (!undisturbed_ || closing_ > 0) return;
    const bool on =
        scenario_.from == Scenario::From::kLinkUp || rate_asked_ ||
        (scenario_.from == Scenario::From::kReady && end_.times.ready != 0 && now_ >= end_.times.ready);
    if (!on) {
        end_.to_board.from = to_board_.sent();
        end_.to_host.from = to_host_.sent();
        return;
    }
    end_.to_board.until = to_board_.sent();
    end_.to_host.until = to_host_.sent();
    if (busy_at_ == now_ && (end_.moments.empty() || end_.moments.back() != now_))
        end_.moments.push_back(end_.times.last = now_);
}

bool Trial::all_well() const {
    return end_.times.ready != 0 && next_step_ == scenario_.steps.size() &&
           next_incident_ == incidents_.size() && ledger_.open() == 0 && !agent_.holds() && is_link_up() &&
           agent_.state() == State::kReady && board_.running(now_) && now_ > end_.times.ready &&
           now_ > (undisturbed_ ? 0 : end_.times.last);
}

void Trial::check_settings() {
    // Nothing shows what became of the request that restores it.
    if (!plan_.extensions && !plan_.to_board.faults.empty()) return;
    // Nothing shows a restart of which the line lost the banner while nothing was asked.
    if (agent_.identified_at() < off_at_) return;
    for (const Step& step : scenario_.steps) {
        const auto& effect = step.command.effect;
        if (!effect || effect->kind != Effect::Kind::kMode || !ledger_.was_executed(step.command.line))
            continue;
        if (modes_[effect->subject] != effect->value)
            ledger_.fail(fmt::format("pin {} is in mode {} of the hardware at the end, and `{}` was ok",
                                     effect->subject, modes_[effect->subject], step.command.line));
    }
    check_levels();
}

// A pin that a command made an output, and that another one set.
void Trial::check_levels() {
    for (const Step& step : scenario_.steps) {
        const auto& effect = step.command.effect;
        if (!effect || effect->kind != Effect::Kind::kLevel || step.command.hold > 0) continue;
        if (!ledger_.was_executed(step.command.line) ||
            !ledger_.was_executed(fmt::format("I,P,{},3", effect->subject)))
            continue;
        if (levels_[effect->subject] != effect->value)
            ledger_.fail(fmt::format("pin {} is at level {} at the end, and `{}` was ok", effect->subject,
                                     levels_[effect->subject], step.command.line));
    }
}

// What is held is on until its end, however often it is renewed, and off then.
void Trial::check_holds() {
    for (const Step& step : scenario_.steps) {
        if (step.command.hold == 0) continue;
        const auto pin = step.command.effect->subject;
        const bool excused = !plan_.extensions && ledger_.counts.not_executed > 0;
        if (levels_[pin] != 0 && !excused)
            ledger_.fail(fmt::format("pin {} is on at the end of its hold", pin));
        const Micros ends = held_from_ + step.command.hold, undone = agent_.undone_at();
        if (undone < ends)
            ledger_.fail(fmt::format("pin {} was undone {} us before its hold was over", pin, ends - undone));
        if (undisturbed_ && undone > ends) ledger_.fail(fmt::format("pin {} was not undone in time", pin));
    }
}

std::string Trial::last_line() const {
    return fmt::format("W,w,{}", kLastMark + closing_);
}

// A command that comes when all is well again. What is left of a damaged line may honestly spoil the first.
void Trial::close() {
    const bool well = all_well() && now_ >= faults_end_;
    if (!well) last_at_ = kNever;
    if (well && last_at_ == kNever) last_at_ = now_ + kQuiet;
    if (well && now_ >= last_at_) {
        last_at_ = kNever;
        ++closing_;
        Command command;
        command.client = kLastClient;
        command.line = last_line();
        command.effect = Effect{Effect::Kind::kMark, 0, kLastMark + closing_};
        command.lasts = 5 * kSecond;
        agent_.submit(command, now_);
    } else if (end_.times.ready != 0 && now_ > std::max(faults_end_, end_.times.ready) + kRecovery) {
        ledger_.fail("the session is not ready long after the last fault");
    }
}

bool Trial::pass_on() {
    now_ = next(next_step());
    if (!to_board_.empty() || !to_host_.empty()) busy_at_ = now_;
    pass();
    steps();
    watch();
    if (closing_ == 0) {
        close();
    } else if (ledger_.open() == 0) {
        if (closing_ == kLastCommands || ledger_.was_executed(last_line())) return false;
        close();
    }
    return !ledger_.failed();
}

TrialEnd Trial::run() {
    ledger_.counts.histories = 1;
    if (!undisturbed_) begin();
    board_.restart(0, 0);
    board_.run(0);
    agent_.link_up(false, 0);
    while (!ledger_.failed() && pass_on()) {
    }
    end_.recovered_after = now_ - std::max(faults_end_, end_.times.ready);
    ledger_.finish();
    if (!ledger_.was_executed(last_line()))
        ledger_.fail("two commands long after the last fault were not executed");
    check_settings();
    check_holds();
    end_.counts = ledger_.counts;
    end_.failure = ledger_.failure();
    end_.trace = std::move(lines_);
    return std::move(end_);
}

namespace {

std::string describe(const ByteFault& fault, const char* where) {
    const auto place = fmt::format("byte {} {}", fault.byte, where);
    switch (fault.kind) {
        case ByteFault::Kind::kLost:
            return place + " lost";
        case ByteFault::Kind::kTwice:
            return place + " twice";
        case ByteFault::Kind::kChanged:
            return fmt::format("{} bit {} changed", place, fault.bit);
        case ByteFault::Kind::kDelayed:
            return fmt::format("{} delayed {} ms", place, fault.lasts / kMillisecond);
        case ByteFault::Kind::kCut:
            return fmt::format("line cut at {} for {} ms", place, fault.lasts / kMillisecond);
    }
    return place;
}

}  // namespace

std::string describe(const Faults& faults) {
    std::string text;
    const auto add = [&](const std::string& one) { text += (text.empty() ? "" : "; ") + one; };
    for (const ByteFault& fault : faults.to_board)
        add(describe(fault, "to the board"));
    for (const ByteFault& fault : faults.to_host)
        add(describe(fault, "to the host"));
    for (const Incident& incident : faults.incidents)
        add(fmt::format("{} at {:.6f} s for {} ms", to_string(incident.kind),
                        static_cast<double>(incident.at) * 1e-6, incident.lasts / kMillisecond));
    return text.empty() ? "nothing" : text;
}

TrialEnd run_trial(const Scenario& scenario, const Faults& faults, Times times, bool trace) {
    return Trial(scenario, faults, times, trace).run();
}

}  // namespace truth
