// SPDX-License-Identifier: Apache-2.0
#include "asip/session/machine.hpp"

namespace asip::session {

namespace {

// A board that gave up a rate, or was left in the middle of a change, is back at its start rate after this.
constexpr Duration kRateGivenUp = std::chrono::milliseconds(650);

}  // namespace

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
