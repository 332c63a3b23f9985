// SPDX-License-Identifier: Apache-2.0
#include "asip/session/rate_change.hpp"

#include "asip/protocol/limits.hpp"
#include "asip/protocol/request.hpp"
#include "asip/session/machine.hpp"

namespace asip::session {

namespace {

// Within the 500 ms after which the board gives up: three tries.
constexpr Duration kFirstFence = std::chrono::milliseconds(140);
constexpr int kFirstFenceTries = 3;
constexpr Duration kAnswer = std::chrono::milliseconds(700);
constexpr Duration kBurstTime = std::chrono::milliseconds(500);
// Three fences of 13 bytes are in flight at a time, as full as requests ever make the board's buffer.
constexpr unsigned kBurst = 30;
constexpr unsigned kWindow = 3;

// A board that gave up a rate, or was left in the middle of a change, is back at its start rate after this.
constexpr Duration kRateGivenUp = std::chrono::milliseconds(650);

}  // namespace

unsigned Rates::best(unsigned max_baud) const {
    for (unsigned rate : kFastRates)
        if (rate <= max_baud && !bad_.contains(rate)) return rate;
    return protocol::kDefaultBaud;
}

RateChange::RateChange(unsigned baud, std::string token_start, Time now, std::vector<std::string>& lines)
    : baud_(baud), token_start_(std::move(token_start)), deadline_(now + kAnswer) {
    lines.push_back(protocol::set_line_rate(static_cast<int>(baud)));
}

bool RateChange::on_event(const protocol::Event& event, Time now, std::vector<std::string>& lines) {
    if (event.service != '#') return false;
    if (step_ == Step::kAsked && event.tag == 'B') {
        if (event.body == std::to_string(baud_))
            step_ = Step::kSwitching;
        else
            step_ = Step::kFailed;
        return true;
    }
    if (event.tag != 'E') return false;
    if (step_ == Step::kFirst && event.body == first_token()) {
        step_ = Step::kBurst;
        deadline_ = now + kBurstTime;
        while (sent_ < kWindow)
            fence(lines);
        return true;
    }
    if (step_ != Step::kBurst) return false;
    if (event.body == first_token()) return true;
    if (event.body != burst_token(received_)) {
        step_ = Step::kFailed;
        return true;
    }
    // Slow is not wrong: the other side, or this one, may have a busy machine.
    deadline_ = now + kBurstTime;
    if (++received_ == kBurst) step_ = Step::kDone;
    if (sent_ < kBurst) fence(lines);
    return true;
}

void RateChange::fence(std::vector<std::string>& lines) {
    lines.push_back(protocol::echo(burst_token(sent_++)));
}

bool RateChange::on_error(const protocol::ErrorReply& error) {
    if (step_ == Step::kAsked && error.service == '#' && error.tag == 'B') {
        step_ = Step::kRefused;
        return true;
    }
    if (step_ != Step::kBurst) return step_ == Step::kFirst;
    step_ = Step::kFailed;
    return true;
}

void RateChange::on_garbage() {
    if (step_ == Step::kBurst) step_ = Step::kFailed;
}

void RateChange::on_rate_set(bool ok, Time now, std::vector<std::string>& lines) {
    if (step_ != Step::kSwitching) return;
    if (!ok) {
        step_ = Step::kFailed;
        return;
    }
    step_ = Step::kFirst;
    tries_ = 1;
    deadline_ = now + kFirstFence;
    lines.push_back(protocol::echo(first_token()));
}

void RateChange::on_deadline(Time now, std::vector<std::string>& lines) {
    if (now < deadline_) return;
    if (step_ == Step::kFirst && tries_ < kFirstFenceTries) {
        ++tries_;
        deadline_ = now + kFirstFence;
        // Ends whatever the change of rate left in the board's line.
        lines.emplace_back();
        lines.push_back(protocol::echo(first_token()));
        return;
    }
    step_ = Step::kFailed;
}

void Machine::on_event(SteppingUp& state, const protocol::Event& event, std::string_view line, Time now,
                       Actions& out) {
    std::vector<std::string> lines;
    if (state.change.on_event(event, now, lines)) {
        write(lines, now, out);
        return follow(state, now, out);
    }
    note_report(event, now);
    if (event.service != '#') out.emplace_back(BoardLine{protocol::ParsedLine(line, event), std::nullopt});
}

void Machine::on_error(SteppingUp& state, const protocol::ErrorReply& error, std::string_view, Time now,
                       Actions& out) {
    if (state.change.on_error(error)) follow(state, now, out);
}

void Machine::on_garbage(SteppingUp& state, Time now, Actions& out) {
    state.change.on_garbage();
    follow(state, now, out);
}

void Machine::on_time(SteppingUp& state, Time now, Actions& out) {
    std::vector<std::string> lines;
    state.change.on_deadline(now, lines);
    write(lines, now, out);
    follow(state, now, out);
}

Time Machine::deadline(const SteppingUp& state) const {
    return state.change.next_deadline();
}

void Machine::follow(SteppingUp& state, Time now, Actions& out) {
    const unsigned baud = state.change.baud();
    switch (state.change.step()) {
        case RateChange::Step::kSwitching:
            return wire_.set_rate(baud, {}, out);
        case RateChange::Step::kDone:
            out.emplace_back(LineRateChanged{wire_.baud(), "stepped up"});
            return become_ready(now, out);
        case RateChange::Step::kRefused:
            rates_.mark_bad(baud);
            return set_up_line(Identity(identity_), now, out);
        case RateChange::Step::kFailed:
            rates_.mark_bad(baud);
            out.emplace_back(
                LineRateChanged{wire_.start_baud(), std::to_string(baud) + " baud does not work here"});
            return search(now + kRateGivenUp, now, out);
        default:
            return;
    }
}

}  // namespace asip::session
