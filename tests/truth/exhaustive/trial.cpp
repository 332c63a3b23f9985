// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/exhaustive/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tests/truth/agent.hpp"
#include "tests/truth/board_model.hpp"

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

class Trial {
  public:
    Trial(const Scenario& scenario, const Faults& faults, Micros ready_at, bool trace)
        : scenario_(scenario),
          plan_(plan_of(scenario, faults)),
          dice_(1),
          undisturbed_(ready_at == 0),
          trace_(trace),
          note_([this](const std::string& text) { note(text); }),
          ledger_(undisturbed_ && plan_.incidents.empty(), plan_.extensions, note_),
          to_board_(plan_.to_board, dice_, on_fault(true)),
          to_host_(plan_.to_host, dice_, on_fault(false)),
          board_(plan_.extensions ? firmware_with_extensions() : firmware_of_04(), to_board_, to_host_, dice_,
                 plan_.board_pass, plan_.idle_pass, !plan_.extensions, reports()),
          agent_(plan_, dice_, ledger_, to_board_, note_),
          incidents_(faults.incidents) {
        end_.ready_at = ready_at;
    }

    TrialEnd run();

  private:
    void note(const std::string& text) {
        if (trace_) end_.trace.push_back(fmt::format("{:10.6f} {}", static_cast<double>(now_) * 1e-6, text));
    }
    Wire::OnFault on_fault(bool to_board);
    BoardModel::Reports reports();
    void board_read(BoardRead read);
    Micros next() const;
    void deliver();
    void begin();
    void steps();
    void incidents();
    void happen(const Incident& incident);
    void link_back();
    void watch();
    void check_settings();
    void close();
    std::string last_line() const;
    bool all_well() const;

    const Scenario& scenario_;
    Plan plan_;
    Dice dice_;
    bool undisturbed_;
    bool trace_;
    Micros now_ = 0;
    TrialEnd end_;
    Ledger::Note note_;
    Ledger ledger_;
    Wire to_board_, to_host_;
    BoardModel board_;
    Agent agent_;
    std::vector<Incident> incidents_;
    std::size_t next_incident_ = 0;
    std::size_t next_step_ = 0;
    Micros link_back_at_ = kNever;
    Micros faults_end_ = 0;
    Micros busy_at_ = 0;  // something was under way
    Micros last_at_ = kNever;
    bool ready_ = false;
    bool rate_asked_ = false;
    int closing_ = 0;                // last commands that were sent
    std::map<unsigned, int> modes_;  // of the board's pins since it restarted
};

Wire::OnFault Trial::on_fault(bool to_board) {
    return [this, to_board](Fault fault, const WireByte& byte) {
        if (trace_)
            note(fmt::format("  {} {}: {:#04x}", to_board ? "to the board" : "to the host", to_string(fault),
                             static_cast<unsigned char>(byte.value)));
        faults_end_ = std::max({faults_end_, byte.departs, byte.arrives});
        ledger_.fault(to_board, fault, byte, now_);
    };
}

BoardModel::Reports Trial::reports() {
    return {[this](BoardRead read) { board_read(std::move(read)); },
            [this](std::uint32_t line, std::string text) {
                if (trace_) note("    board says " + text);
                ledger_.board_sent(line, std::move(text), now_);
            },
            [this](Fault fault, const WireByte& byte) {
                if (trace_) note(fmt::format("  board: {}", to_string(fault)));
                ledger_.fault(true, fault, byte, now_);
            },
            [this](const char* state) {
                note(state);
                if (!board_.running(now_)) modes_.clear();
            }};
}

void Trial::board_read(BoardRead read) {
    if (trace_) note("    board reads " + read.text);
    for (const Effect& effect : read.effects)
        if (effect.kind == Effect::Kind::kMode) modes_[effect.subject] = effect.value;
    if (scenario_.from == Scenario::From::kRate && !rate_asked_ && read.text.starts_with("#,B,")) {
        rate_asked_ = true;
        end_.to_board.from = to_board_.sent() - read.text.size() - 1;
        end_.to_host.from = to_host_.sent();
    }
    ledger_.board_read(std::move(read));
}

Micros Trial::next() const {
    Micros next = std::min({agent_.next(), board_.next(), link_back_at_, last_at_});
    if (!to_host_.empty()) next = std::min(next, to_host_.next());
    if (next_step_ < scenario_.steps.size() && end_.ready_at != 0)
        next = std::min(next, end_.ready_at + scenario_.steps[next_step_].after);
    if (next_incident_ < incidents_.size()) next = std::min(next, incidents_[next_incident_].at);
    return std::max(next, now_);
}

void Trial::deliver() {
    std::string bytes;
    while (!to_host_.empty() && to_host_.next() <= now_) {
        WireByte byte = to_host_.take();
        if (byte.baud != agent_.baud()) {
            ledger_.fault(false, Fault::kNoise, byte, now_);
            byte.value = static_cast<char>(dice_.below(256));
        }
        bytes += byte.value;
    }
    if (bytes.empty() || link_back_at_ != kNever) return;
    if (trace_) note("< " + bytes);
    agent_.receive(bytes, now_);
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
        agent_.submit(scenario_.steps[next_step_++].command, now_);
}

void Trial::incidents() {
    while (next_incident_ < incidents_.size() && incidents_[next_incident_].at <= now_)
        happen(incidents_[next_incident_++]);
    if (link_back_at_ <= now_) link_back();
}

void Trial::happen(const Incident& incident) {
    if (link_back_at_ != kNever) return;
    note(to_string(incident.kind));
    ++ledger_.counts.incidents;
    faults_end_ = std::max(faults_end_, now_ + incident.lasts + plan_.boot);
    switch (incident.kind) {
        case Incident::Kind::kBoardReset:
            return board_.restart(now_, now_ + plan_.boot);
        case Incident::Kind::kHang:
            return board_.hang(now_, now_ + incident.lasts);
        case Incident::Kind::kDie:
            return board_.restart(now_, now_ + incident.lasts + plan_.boot);
        case Incident::Kind::kAgentRestart:
            return agent_.restart(now_);
        case Incident::Kind::kUnplug:
        case Incident::Kind::kReopen:
            agent_.link_down(now_);
            board_.restart(now_, kNever);
            to_board_.clear(now_);
            to_host_.clear(now_);
            link_back_at_ = now_ + incident.lasts;
    }
}

void Trial::link_back() {
    link_back_at_ = kNever;
    board_.restart(now_, now_ + plan_.boot);
    agent_.link_up(true, now_);
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
           next_incident_ == incidents_.size() && ledger_.open() == 0 && link_back_at_ == kNever &&
           agent_.state() == State::kReady && board_.running(now_) && now_ > end_.ready_at;
}

void Trial::check_settings() {
    // Nothing shows what became of the request that restores it.
    if (!plan_.extensions && !plan_.to_board.faults.empty()) return;
    for (const Step& step : scenario_.steps) {
        const auto& effect = step.command.effect;
        if (!effect || effect->kind != Effect::Kind::kMode || !ledger_.was_executed(step.command.line))
            continue;
        if (modes_[effect->subject] != effect->value)
            ledger_.fail(fmt::format("pin {} is in mode {} of the hardware at the end, and `{}` was ok",
                                     effect->subject, modes_[effect->subject], step.command.line));
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

TrialEnd Trial::run() {
    ledger_.counts.histories = 1;
    if (!undisturbed_) begin();
    board_.restart(0, 0);
    board_.run(0);
    agent_.link_up(false, 0);
    while (!ledger_.failed()) {
        now_ = next();
        if (!to_board_.empty() || !to_host_.empty()) busy_at_ = now_;
        incidents();
        while (board_.next() <= now_)
            board_.run(now_);
        deliver();
        agent_.tick(now_);
        steps();
        watch();
        if (closing_ == 0) {
            close();
        } else if (ledger_.open() == 0) {
            if (closing_ == kLastCommands || ledger_.was_executed(last_line())) break;
            close();
        }
    }
    end_.recovered_after = now_ - std::max(faults_end_, end_.ready_at);
    ledger_.finish();
    if (!ledger_.was_executed(last_line()))
        ledger_.fail("two commands long after the last fault were not executed");
    check_settings();
    end_.counts = ledger_.counts;
    end_.failure = ledger_.failure();
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

TrialEnd run_trial(const Scenario& scenario, const Faults& faults, Micros ready_at, bool trace) {
    return Trial(scenario, faults, ready_at, trace).run();
}

}  // namespace truth
