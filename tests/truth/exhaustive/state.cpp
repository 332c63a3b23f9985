// SPDX-License-Identifier: Apache-2.0
// All that decides how a history goes on, as a number. It reads what session, agent and ledger keep to
// themselves; their headers need not know of it.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "asip/expected.hpp"
#ifdef __clang__
#pragma clang diagnostic ignored "-Wkeyword-macro"
#endif
#define private public
#define protected public
#include "tests/truth/exhaustive/state_of_session.hpp"
#undef private
#undef protected

namespace truth {

/// Times are relative to the present one, numbers to the last one given. Not read, because nothing depends on
/// them: what is counted for a log, the maps of pins of a board, and what the ledger remembers of commands,
/// lines and executions that no open command can have to do with.
class StateReader : public StateOfSession {
  public:
    StateReader(const Trial& trial, Fingerprint& print, bool exact)
        : StateOfSession(print, trial.now_, exact),
          trial_(trial),
          ledger_(trial.ledger_),
          agent_(trial.agent_) {}

    void read(Fingerprint& print) {
        since_ = oldest_open();
        add(trial_.dice_.drawn());
        add(now_ % std::max({trial_.plan_.to_host.bunch, trial_.plan_.to_board.bunch, Micros{1000}}));
        add_trial();
        add_wire(trial_.to_board_, true);
        add_wire(trial_.to_host_, false);
        add_board(trial_.board_);
        add_agent();
        add_ledger();
        trial_.board_.firmware().add_to(print, now_);
    }

  private:
    void sources(const std::vector<std::uint32_t>& lines) {
        add(lines.size());
        for (const auto line : lines)
            add(ledger_.wire_line_ - line);
    }

    // --- line and board

    void add_trial() {
        const Trial& of = trial_;
        add(of.scenario_.steps.size() - of.next_step_);
        const bool begins = of.next_step_ < of.scenario_.steps.size() || now_ <= of.end_.times.ready;
        add(begins ? now_ - of.end_.times.ready : Micros{-1});
        until(of.end_.times.last);
        for (auto i = of.next_incident_; i < of.incidents_.size(); ++i) {
            add(of.incidents_[i].kind);
            at(of.incidents_[i].at);
        }
        at(of.link_back_at_);
        lately(of.faults_end_);
        at(of.last_at_);
        add(of.closing_);
        add(of.modes_);
        add(of.levels_);
        at(of.held_from_);
        const Agent& agent = of.agent_;
        add(agent.identified_at_ < of.off_at_);
        add(agent.identified_at_ > 0);
        add(of.plan_.to_board.faults.empty());
        add(of.plan_.to_board.faults.size() + of.plan_.to_host.faults.size() > 1);
    }

    void add_wire(const Wire& wire, bool to_board) {
        add(wire.bytes_.size());
        for (const WireByte& byte : wire.bytes_) {
            add(byte.value);
            if (to_board) add(ledger_.wire_line_ - byte.line);
            add(byte.baud);
            at(byte.departs);
            at(byte.arrives);
        }
        until(wire.free_);
        until(wire.spaced_);
        add(wire.losing_);
        until(wire.cut_until_);
    }

    using StateParts::add;
    void add(const BoardRead& read) {
        at(read.at == 0 ? kNever : read.at);
        at(read.whole_at == 0 ? kNever : read.whole_at);
        add(read.text);
        sources(read.sources);
        add(read.effects);
        add(read.reply);
    }

    void add_board(const BoardModel& board) {
        add(board.on_);
        add(board.busy_);
        at(board.on_at_);
        until(board.hangs_until_);
        at(board.last_pass_);
        until(board.blocked_until_);
        add(board.received_);
        for (const auto line : board.received_from_)
            add(ledger_.wire_line_ - line);
        add(board.reading_);
        add(board.sending_);
    }

    // --- the agent and its session

    void add_agent() {
        std::map<std::uint64_t, std::size_t> commands(agent_.commands_.begin(), agent_.commands_.end());
        add(commands.size());
        for (const auto& [id, index] : commands) {
            request_id(id);
            add(index);
        }
        std::map<std::uint64_t, std::string> safe(agent_.safe_.begin(), agent_.safe_.end());
        add(safe.size());
        for (const auto& [id, line] : safe) {
            request_id(id);
            add(line);
        }
        add(agent_.holds_.holds_.size());
        for (const auto& [line, entry] : agent_.holds_.holds_) {
            add(line);
            add(entry.hold.client);
            add(entry.hold.line);
            add(entry.hold.length);
            add(entry.hold.ends);
            request_id(entry.hold.request);
            add(entry.in_force);
            add(entry.maybe_before);
        }
        add(agent_.safe_lines_.pending_.size());
        for (const auto& [line, state] : agent_.safe_lines_.pending_) {
            add(line);
            request_id(state.request);
            add(state.refused);
        }
        std::map<std::uint64_t, std::string> undoing(agent_.safe_lines_.requests_.begin(),
                                                     agent_.safe_lines_.requests_.end());
        add(undoing.size());
        for (const auto& [id, line] : undoing) {
            request_id(id);
            add(line);
        }
        at(agent_.undone_at_);
        add(agent_.taken_for_another_);
        add(agent_.baud_);
        at(agent_.rate_set_at_);
        if (agent_.rate_set_at_ != kNever) add(agent_.wanted_baud_);
        add(agent_.held_);
        add(agent_.last_tick_ == now_ ? agent_.ticks_at_once_ + 1 : 0);
        at(agent_.asked_);
        at(agent_.last_byte_);
        add_machine(*agent_.session_);
    }
    void request_id(std::uint64_t id) { add_request_id(*agent_.session_, id); }

    // --- the ledger

    using Entry = Ledger::Entry;
    static bool is_open(const Entry& entry) {
        return entry.state != Ledger::State::kEnded && !entry.abandoned;
    }

    // What was before it concerns no command that is open or still to come.
    Micros oldest_open() const {
        Micros oldest = now_;
        for (const Entry& entry : ledger_.entries_)
            if (entry.state == Ledger::State::kSent && is_open(entry))
                oldest = std::min(oldest, ledger_.sent(entry));
        return oldest;
    }

    void add_ledger() {
        std::size_t arrived = ledger_.arrived_.size();
        for (const Entry& entry : ledger_.entries_) {
            add_entry(entry);
            if (is_open(entry) && entry.state == Ledger::State::kSent)
                arrived = std::min(arrived, entry.arrived);
        }
        add(ledger_.open_);
        add(ledger_.turns_.known_);
        if (ledger_.turns_.known_) {
            add(ledger_.turns_.waiting_);
            add(ledger_.turns_.passed_);
        }
        for (const auto& one : ledger_.executions_)
            add_execution(one);
        for (const auto& line : ledger_.board_lines_)
            if (line.at >= since_) add_line(line);
        add(-1);
        for (auto i = arrived; i < ledger_.arrived_.size(); ++i)
            add_line(ledger_.arrived_[i]);
        add(-1);
        for (const auto& fence : ledger_.fences_)
            if (fence.at >= since_) add_line(fence);
        add(ledger_.damage_.empty());
        if (!ledger_.damage_.empty()) lately(ledger_.damage_.back());
        add(ledger_.partial_);
        add(ledger_.counts.not_executed > 0);
    }
    void add_line(const Ledger::Line& line) {
        at(line.at);
        add(line.text);
    }

    // One that ended may still be mixed up with another that looks the same, and explain an error.
    void add_entry(const Entry& entry) {
        add(entry.command.line);
        add(entry.state);
        add(entry.abandoned);
        add(entry.executed);
        add(entry.sent != kNever && ledger_.damaged_to_board_[entry.wire_line]);
        const bool has_twins = ledger_.by_line_.at(entry.command.line).size() > 1;
        const bool over = entry.ended < since_ && !has_twins;
        add(over);
        add(entry.sent == kNever);
        if (over) {
            if (entry.ended >= entry.deadline) lately(entry.ended);
            return;
        }
        at(entry.submitted);
        at(entry.deadline);
        at(entry.sent);
        at(entry.ended);
        add(entry.checksum);
        add(ledger_.wire_line_ - entry.wire_line);
        add(ledger_.arrived_.size() - entry.arrived);
    }

    void add_execution(const Ledger::Execution& one) {
        const bool over = one.read.at < since_;
        if (!over) {
            add(-2);
            add(one.read);
            add(one.error);
            add(one.used);
        } else if (one.error >= 0 && one.read.sources.size() == 1) {
            // It may explain the same error of another.
            const auto its =
                std::find_if(ledger_.entries_.begin(), ledger_.entries_.end(), [&](const Entry& entry) {
                    return entry.sent != kNever && entry.wire_line == one.read.sources[0];
                });
            if (its == ledger_.entries_.end()) return;
            add(-3);
            add(its - ledger_.entries_.begin());
            add(one.error);
        }
    }

    const Trial& trial_;
    const Ledger& ledger_;
    const Agent& agent_;
    Micros since_ = 0;
};

Trial::Here Trial::here() const {
    Fingerprint print;
    StateReader reader(*this, print, false);
    reader.read(print);
    return {print.value(), reader.is_recent()};
}

std::uint64_t Trial::state_and_place() const {
    Fingerprint print;
    StateReader(*this, print, true).read(print);
    print.add(now_);
    print.add(to_board_.sent());
    print.add(to_host_.sent());
    return print.value();
}

}  // namespace truth
