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
#define private public
#define protected public
#include "tests/truth/exhaustive/trial.hpp"
#undef private
#undef protected

namespace truth {

namespace session = asip::session;
namespace protocol = asip::protocol;

/// Times are relative to the present one, numbers to the last one given. Not read, because nothing depends on
/// them: what is counted for a log, the maps of pins of a board, and what the ledger remembers of commands,
/// lines and executions that no open command can have to do with.
class StateReader {
  public:
    /// `exact`: how long ago something was counts exactly, also where it was lately.
    StateReader(const Trial& trial, Fingerprint& print, bool exact)
        : trial_(trial),
          ledger_(trial.ledger_),
          agent_(trial.agent_),
          now_(trial.now_),
          exact_(exact),
          print_(print) {}

    void read() {
        since_ = oldest_open();
        add(trial_.dice_.drawn());
        add(now_ % std::max({trial_.plan_.to_host.bunch, trial_.plan_.to_board.bunch, Micros{1000}}));
        add_trial();
        add_wire(trial_.to_board_, true);
        add_wire(trial_.to_host_, false);
        add_board(trial_.board_);
        add_agent();
        add_ledger();
        trial_.board_.firmware().add_to(print_, now_);
    }

    /// Something was lately.
    bool is_recent() const { return recent_; }

  private:
    // --- parts

    template <class T>
        requires std::is_integral_v<T> || std::is_enum_v<T>
    void add(T value) {
        print_.add(value);
    }
    void add(std::string_view text) { print_.add(text); }
    void add(const std::string& text) { print_.add(std::string_view(text)); }
    void add(asip::Duration time) { print_.add(time.count()); }
    void add(asip::Time time) {
        const bool is_time = time != asip::Time::max() && time != asip::Time::min() && time != asip::Time{};
        print_.add(is_time ? (time - present()).count() : time.time_since_epoch().count() ^ 1);
    }
    template <class T>
    void add(const std::optional<T>& value) {
        add(value.has_value());
        if (value) add(*value);
    }
    template <class A, class B>
    void add(const std::pair<A, B>& both) {
        add(both.first);
        add(both.second);
    }
    template <class List>
        requires requires(const List& list) { list.begin(), list.size(); }
    void add(const List& list) {
        add(list.size());
        for (const auto& one : list)
            add(one);
    }
    asip::Time present() const {
        return asip::Time{} + std::chrono::hours(1) + std::chrono::microseconds(now_);
    }
    /// A time in microseconds.
    void at(Micros time) { add(time == kNever ? time : time - now_); }
    /// One that does not count once it is over.
    void until(Micros time) { add(time == kNever ? time : std::max<Micros>(time - now_, 0)); }
    /// One of which only counts whether it was long ago (kRecent).
    void lately(Micros time) {
        const Micros age = now_ - time;
        const bool recent = !exact_ && age >= 0 && age < kRecent;
        recent_ = recent_ || recent;
        add(recent ? Micros{0} : age);
    }
    void sources(const std::vector<std::uint32_t>& lines) {
        add(lines.size());
        for (const auto line : lines)
            add(ledger_.wire_line_ - line);
    }
    void add(const Effect& effect) {
        add(effect.kind);
        add(effect.subject);
        add(effect.value);
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
    void request_id(std::uint64_t id) { add(id == 0 ? 0 : agent_.session_->next_id_ - id); }

    void add_machine(const session::Machine& of) {
        add(of.state_.index());
        std::visit([&](const auto& state) { add_state(state); }, of.state_);
        add_session_wire(of.wire_);
        add_queue(of.queue_);
        add(of.settings_.modes_);
        add(of.settings_.periods_);
        add(of.rates_.bad_);
        add_identity(of.identity_);
        add(of.known_ << 10 | of.there_ << 9 | of.was_silent_ << 8 | of.no_answer_reported_ << 7 |
            of.damage_seen_ << 6 | of.checksums_seen_ << 5 | of.changed_ << 4 | of.restore_ << 3 |
            of.restore_again_ << 2 | of.banner_ << 1);
        add(of.unconfirmed_.has_value());
        if (of.unconfirmed_) {
            add_identity(of.unconfirmed_->said);
            add(of.unconfirmed_->times);
        }
        add(of.restored_again_at_);
        add(of.banner_services_);
        add(of.suspect_baud_);
        add(of.ready_baud_);
        add(of.reports_.size());
        for (const auto& report : of.reports_) {
            add(report.service);
            add(report.tag);
            add(report.last);
        }
        add(of.new_periods_.size());
        for (const auto& period : of.new_periods_) {
            add(period.service);
            add(period.in_doubt);
            add(period.at);
        }
        add(of.renewals_.size());
        for (const auto& [service, renewal] : of.renewals_) {
            add(service);
            add(renewal.asked);
            add(renewal.reported);
            add(renewal.patience);
            add(renewal.pending);
            add(renewal.gap);
            add(renewal.gaps);
        }
        add(of.last_report_);
        add(of.progress_at_);
        add(of.found_at_);
        add(of.last_byte_);
        add(of.asked_at_);
        add(of.leaving_.has_value());
        add(of.overlong_seen_ == of.wire_.reader_.overlong_lines_);
    }

    void add_state(const session::Machine::Down&) {}
    void add_state(const session::Machine::Searching& state) {
        const auto& search = state.search;
        add(search.rates_);
        add(search.index_);
        add(search.asked_);
        add(search.turn_);
        add(search.heard_);
        add(search.bytes_came_);
        add(search.quiet_until_);
        add(search.deadline_);
        add(state.since);
    }
    void add_state(const session::Machine::Identifying& state) {
        const auto& interview = state.interview;
        add(interview.progress_);
        add(interview.step_);
        add(interview.tries_);
        add(interview.tries_at_once_);
        add(interview.rounds_);
        add(interview.refusals_);
        add(interview.unanswered_);
        add(interview.once_more_);
        add(interview.extensions_.list);
        add(interview.asked_);
        add(interview.turn_checksums_on_);
        add(interview.banner_services_);
        add(interview.other_question_);
        add_identity(interview.identity_);
        add(state.turn);
        add(state.answers);
    }
    void add_state(const session::Machine::SteppingUp& state) {
        const auto& change = state.change;
        add(change.step_);
        add(change.baud_);
        add(change.token_start_);
        add(change.tries_);
        add(change.sent_);
        add(change.received_);
        add(change.deadline_);
    }
    void add_state(const session::Machine::Ready& state) {
        add(state.garbage);
        if (state.garbage > 0) add(state.garbage_since);
    }

    void add_identity(const session::Identity& of) {
        add(of.info.major);
        add(of.info.minor);
        add(of.info.chip);
        add(of.info.pins);
        add(of.info.sketch);
        add(of.stored_name);
        add(of.services.size());
        for (const auto& service : of.services) {
            add(service.id);
            add(service.name);
        }
        add(of.extensions.list);
        add(of.pin_owners);
    }

    void add_session_wire(const session::Wire& wire) {
        add(wire.reader_.line_);
        add(wire.reader_.dropping_);
        add(wire.checksums_);
        add(wire.had_checksums_);
        add(wire.start_baud_);
        add(wire.baud_);
    }

    void add_queue(const session::RequestQueue& of) {
        const auto& waiting = of.waiting_;
        add_requests(waiting.urgent_);
        add_requests(waiting.own_);
        add(waiting.turns_.size());
        for (const auto client : waiting.turns_) {
            add(client);
            add_requests(waiting.queues_.at(client));
        }
        add(waiting.earliest_);
        add_in_flight(of.in_flight_);
        const auto& fences = of.fences_;
        add(fences.echo_ << 2 | fences.verified_ << 1 | fences.second_next_);
        add(fences.second_);
        add(fences.token_);
        add(fences.stride_);
        add(of.digest_known_ << 5 | of.reporting_ << 4 | of.stalled_ << 3 | of.held_back_ << 2 |
            of.probe_wanted_ << 1 | of.fills_batch_);
        add(of.checksum_bytes_);
        add(of.longest_request_);
        add(of.byte_time_);
        add(of.settled_at_);
        add(of.lost_fences_);
    }
    template <class List>
    void add_requests(const List& list) {
        add(list.size());
        for (const session::Request& one : list)
            add_request(one);
    }
    void add_request(const session::Request& of) {
        request_id(of.id);
        add(of.client);
        add(of.line);
        add(of.deadline);
        add(of.prove << 3 | of.urgent << 2 | of.alone << 1 | bool(of.is_answer));
        add(of.answer_tag);
        add(of.answer_time);
    }

    void add_in_flight(const session::InFlight& of) {
        const auto number = [&](std::uint64_t one) { add(of.next_number_ - one); };
        const auto item = [&](const session::InFlight::Item& one) {
            add_request(one.request);
            add(one.ended << 7 | one.asked << 6 | one.doubted << 5 | one.follows_owed << 4 |
                one.behind_fence << 3 | one.has_value << 2 | one.suspected << 1);
            number(one.number);
            add(one.answer.text_);
            add(one.error);
            add(one.value_error);
        };
        add(of.batches_.size());
        for (const auto& batch : of.batches_) {
            add(batch.items.size());
            for (const auto& one : batch.items)
                item(one);
            add(batch.unclear.size());
            for (const auto& unclear : batch.unclear) {
                add(unclear.code);
                add(unclear.text);
                add(unclear.candidates);
            }
            add(batch.fence.line);
            add(batch.fence.token);
            add(batch.fence.verifies);
            add(batch.bytes);
            number(batch.number);
            add(batch.last_sent);
            add(batch.close_after);
            add(batch.overdue);
        }
        add(of.awaiting_.size());
        for (const auto& awaiting : of.awaiting_) {
            item(awaiting.item);
            add(awaiting.until);
            add(awaiting.latest);
        }
        add(of.lost_tokens_);
        add(of.owed_.size());
        for (const auto& owed : of.owed_) {
            number(owed.number);
            add(owed.service);
            add(owed.tag);
            add(owed.sent_by);
            number(owed.ended);
            add(owed.answer_time);
            add(owed.looks);
        }
        add(of.slow_);
        add(of.bytes_);
        add(of.stood_still_);
        add(of.last_back_);
        add(of.usual_way_);
        add(of.earliest_);
    }

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
    const Micros now_;
    const bool exact_;
    Micros since_ = 0;
    bool recent_ = false;
    Fingerprint& print_;
};

Trial::Here Trial::here() const {
    Fingerprint print;
    StateReader reader(*this, print, false);
    reader.read();
    return {print.value(), reader.is_recent()};
}

std::uint64_t Trial::state_and_place() const {
    Fingerprint print;
    StateReader(*this, print, true).read();
    print.add(now_);
    print.add(to_board_.sent());
    print.add(to_host_.sent());
    return print.value();
}

}  // namespace truth
