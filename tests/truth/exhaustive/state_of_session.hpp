// SPDX-License-Identifier: Apache-2.0
// What decides how a session goes on. Included where it may read what its classes keep to themselves.
#pragma once
#include "asip/session/machine.hpp"
#include "tests/truth/exhaustive/state_parts.hpp"

namespace truth {

namespace session = asip::session;

class StateOfSession : public StateParts {
  public:
    using StateParts::StateParts;

    /// Numbers of requests are relative to the last one given.
    void add_request_id(const session::Machine& of, std::uint64_t id) { add(id == 0 ? 0 : of.next_id_ - id); }
    void add_machine(const session::Machine& of) {
        next_id_ = of.next_id_;
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

  private:
    void request_id(std::uint64_t id) { add(id == 0 ? 0 : next_id_ - id); }

    std::uint64_t next_id_ = 0;
};

}  // namespace truth
