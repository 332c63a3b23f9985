// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/exhaustive/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "tests/truth/world.hpp"

namespace truth {

namespace {

using State = asip::session::BoardSession::State;

// What a command that comes when all is well again has executed.
constexpr int kLastMark = 900;
constexpr int kLastCommands = 2;
constexpr unsigned kLastClient = 9;
// So long nothing may be under way before it.
constexpr Micros kQuiet = 20 * kMillisecond;

Plan plan_of(const Scenario& scenario, const Faults& faults) {
    Plan plan = scenario.plan;
    plan.to_board.faults = faults.to_board;
    plan.to_host.faults = faults.to_host;
    return plan;
}

// What of a trial changes.
struct TrialState {
    TrialEnd end_;
    std::size_t next_step_ = 0;
    Micros faults_end_ = 0;
    Micros busy_at_ = 0;  // something was under way
    Micros last_at_ = kNever;
    bool ready_ = false;
    bool rate_asked_ = false;
    int closing_ = 0;                // last commands that were sent
    std::map<unsigned, int> modes_;  // of the board's pins since it restarted
    std::map<unsigned, int> levels_;
    Micros off_at_ = 0;          // the board, for the last time
    Micros held_from_ = kNever;  // the last renewal, or the beginning
};

class Trial : World, TrialState {
  public:
    Trial(const Scenario& scenario, const Faults& faults, Micros ready_at, bool trace)
        : World(setting_of(scenario, faults, ready_at, trace)),
          scenario_(scenario),
          undisturbed_(ready_at == 0) {
        incidents_ = faults.incidents;
        end_.ready_at = ready_at;
    }

    TrialEnd run();

    /// At the beginning.
    void power_up();
    /// Goes on where `other` was when its firmware was saved. No fault of this one is before that.
    void resume(const Trial& other, const Firmware::Saved& saved);
    TrialEnd go_on();
    /// One step; false: the end.
    bool pass_on();
    bool closes() const { return closing_ > 0 || last_at_ != kNever; }
    Range sent() const { return {to_board_.sent(), to_host_.sent()}; }
    Micros now() const { return now_; }
    std::unique_ptr<const Firmware::Saved> save() const { return board_.firmware().save(); }

  private:
    static Setting setting_of(const Scenario& scenario, const Faults& faults, Micros ready_at, bool trace);
    void on_fault(const WireByte& byte) override;
    void on_read(const BoardRead& read) override;
    void on_board_off() override;
    void on_incident(const Incident& incident) override;
    Micros next_step() const;
    void begin();
    void steps();
    void step(const Step& step);
    void check_holds();
    void watch();
    void check_settings();
    void close();
    std::string last_line() const;
    bool all_well() const;

    const Scenario& scenario_;
    bool undisturbed_;
};

World::Setting Trial::setting_of(const Scenario& scenario, const Faults& faults, Micros ready_at,
                                 bool trace) {
    auto plan = plan_of(scenario, faults);
    const bool calm = ready_at == 0 && plan.incidents.empty();
    return {Dice(1), std::move(plan), calm, trace};
}

void Trial::on_fault(const WireByte& byte) {
    faults_end_ = std::max({faults_end_, byte.departs, byte.arrives});
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
    if (next_step_ == scenario_.steps.size() || end_.ready_at == 0) return last_at_;
    return std::min(last_at_, end_.ready_at + scenario_.steps[next_step_].after);
}

// The scenario's own incidents come so long after the board was ready, as its steps do.
void Trial::begin() {
    for (Incident incident : plan_.incidents) {
        incident.at += end_.ready_at;
        incidents_.push_back(incident);
    }
    std::sort(incidents_.begin(), incidents_.end(),
              [](const Incident& a, const Incident& b) { return a.at < b.at; });
}

void Trial::steps() {
    if (end_.ready_at == 0) return;
    while (next_step_ < scenario_.steps.size() && end_.ready_at + scenario_.steps[next_step_].after <= now_)
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
            end_.ready_at = now_ + kQuiet;
            begin();
        }
    }
    if (!undisturbed_ || closing_ > 0) return;
    const bool on = scenario_.from == Scenario::From::kLinkUp || rate_asked_ ||
                    (scenario_.from == Scenario::From::kReady && end_.ready_at != 0 && now_ >= end_.ready_at);
    if (!on) {
        end_.to_board.from = to_board_.sent();
        end_.to_host.from = to_host_.sent();
        return;
    }
    end_.to_board.until = to_board_.sent();
    end_.to_host.until = to_host_.sent();
    if (busy_at_ == now_ && (end_.moments.empty() || end_.moments.back() != now_))
        end_.moments.push_back(now_);
}

bool Trial::all_well() const {
    return end_.ready_at != 0 && next_step_ == scenario_.steps.size() &&
           next_incident_ == incidents_.size() && ledger_.open() == 0 && !agent_.holds() && is_link_up() &&
           agent_.state() == State::kReady && board_.running(now_) && now_ > end_.ready_at;
}

void Trial::check_settings() {
    // Nothing shows what became of the request that restores it.
    if (!plan_.extensions && !plan_.to_board.faults.empty()) return;
    // Nothing shows a restart of which the line lost the banner while nothing was asked.
    if (agent_.identified_at() < off_at_) return;
    // The line changed what it said of itself behind a restart. Counted.
    if (agent_.taken_for_another()) {
        ++ledger_.counts.not_restored;
        return;
    }
    for (const Step& step : scenario_.steps) {
        const auto& effect = step.command.effect;
        if (!effect || effect->kind != Effect::Kind::kMode || !ledger_.was_executed(step.command.line))
            continue;
        if (modes_[effect->subject] != effect->value)
            ledger_.fail(fmt::format("pin {} is in mode {} of the hardware at the end, and `{}` was ok",
                                     effect->subject, modes_[effect->subject], step.command.line));
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
    } else if (end_.ready_at != 0 && now_ > std::max(faults_end_, end_.ready_at) + kRecovery) {
        ledger_.fail("the session is not ready long after the last fault");
    }
}

void Trial::power_up() {
    ledger_.counts.histories = 1;
    if (!undisturbed_) begin();
    board_.restart(0, 0);
    board_.run(0);
    agent_.link_up(false, 0);
}

void Trial::resume(const Trial& other, const Firmware::Saved& saved) {
    World::resume(other);
    TrialState::operator=(other);
    board_.firmware().put_back(saved);
    begin();
    while (next_incident_ < incidents_.size() && incidents_[next_incident_].at <= now_)
        ++next_incident_;
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
    power_up();
    return go_on();
}

TrialEnd Trial::go_on() {
    while (!ledger_.failed() && pass_on()) {
    }
    end_.recovered_after = now_ - std::max(faults_end_, end_.ready_at);
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

struct Undisturbed::Point {
    std::unique_ptr<Trial> trial;
    std::unique_ptr<const Firmware::Saved> firmware;

    bool is_before(const Faults& faults) const {
        const auto sent = trial->sent();
        const auto later = [](std::uint64_t next) {
            return [next](const ByteFault& fault) { return fault.byte >= next; };
        };
        return std::all_of(faults.to_board.begin(), faults.to_board.end(), later(sent.from)) &&
               std::all_of(faults.to_host.begin(), faults.to_host.end(), later(sent.until)) &&
               std::all_of(faults.incidents.begin(), faults.incidents.end(),
                           [&](const Incident& incident) { return incident.at > trial->now(); });
    }
};

// Until it closes: whether it does depends on what is still to come.
Undisturbed::Undisturbed(const Scenario& scenario)
    : scenario_(scenario), end_(run_trial(scenario, {}, 0, false)) {
    if (!end_.failure.empty()) return;
    Trial trial(scenario, {}, end_.ready_at, false);
    trial.power_up();
    while (trial.pass_on() && !trial.closes()) {
        const auto sent = trial.sent();
        const bool near = scenario.from != Scenario::From::kReady || trial.now() + kQuiet >= end_.ready_at;
        if (!near || sent.from > end_.to_board.until || sent.until > end_.to_host.until) continue;
        auto point = std::make_unique<Trial>(scenario, Faults{}, end_.ready_at, false);
        auto firmware = trial.save();
        point->resume(trial, *firmware);
        points_.push_back({std::move(point), std::move(firmware)});
    }
}

Undisturbed::~Undisturbed() = default;

TrialEnd Undisturbed::run(const Faults& faults) const {
    const auto after = std::partition_point(points_.begin(), points_.end(),
                                            [&](const Point& point) { return point.is_before(faults); });
    if (after == points_.begin()) return run_trial(scenario_, faults, end_.ready_at, false);
    Trial trial(scenario_, faults, end_.ready_at, false);
    trial.resume(*std::prev(after)->trial, *std::prev(after)->firmware);
    return trial.go_on();
}

TrialEnd run_trial(const Scenario& scenario, const Faults& faults, Micros ready_at, bool trace) {
    return Trial(scenario, faults, ready_at, trace).run();
}

}  // namespace truth
