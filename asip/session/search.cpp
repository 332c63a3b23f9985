// SPDX-License-Identifier: Apache-2.0
#include "asip/session/search.hpp"

#include <algorithm>
#include <utility>

#include "asip/protocol/message.hpp"
#include "asip/protocol/request.hpp"
#include "asip/session/machine.hpp"
#include "asip/session/rate_change.hpp"

namespace asip::session {

namespace {

constexpr Duration kAtStartRate = std::chrono::milliseconds(600);
constexpr Duration kAtOtherRates = std::chrono::milliseconds(200);
// The second of a 0.4 board, and the way there. Behind the third of four questions: a question that was lost
// is asked again soon.
constexpr Duration kSilence = std::chrono::milliseconds(1100);
constexpr int kLongestTurn = 4;
constexpr std::size_t kPatientTurns = 6;  // 5 s: a boot loader and the sketch's own start

}  // namespace

int Search::longer(int turn) {
    return std::min(2 * turn, kLongestTurn);
}

void Search::start(unsigned start_baud, bool rates, int turn, Time quiet_until, Time now, bool patient) {
    patient_turns_ = patient ? kPatientTurns : 1;
    rates_.assign(patient_turns_, start_baud);
    if (rates)
        for (unsigned rate : {500'000u, 1'000'000u, 250'000u, 115'200u})
            if (rate != start_baud) rates_.push_back(rate);
    turn_ = turn;
    index_ = last_ = first_turn();
    asked_ = asked_at_start_ = 0;
    heard_ = bytes_came_ = false;
    quiet_until_ = quiet_until;
    deadline_ = now;
}

Search::Step Search::next(Time now) {
    if (std::exchange(heard_, false)) index_ = last_;
    last_ = index_;
    const unsigned baud = rates_[index_];
    if (now < quiet_until_) {
        deadline_ = quiet_until_;
        return {baud, false, false};
    }
    // At the start rate twice, the second time behind a newline.
    const bool at_start = baud == rates_.front();
    const Step step{baud, true, !at_start || asked_ % 2 == 1};
    Duration listens = (at_start ? kAtStartRate / 2 : kAtOtherRates) * turn_;
    if (at_start && ++asked_at_start_ % 4 == 3) listens = std::max(listens, kSilence);
    deadline_ = now + listens;
    ++asked_;
    if (at_start && asked_ % 2 == 1) return step;
    asked_ = 0;
    if (++index_ < rates_.size()) return step;
    if (rates_.size() > 1 && std::exchange(bytes_came_, false)) turn_ = longer(turn_);
    index_ = first_turn();
    return step;
}

// Longer turns need fewer of them for the same patience.
std::size_t Search::first_turn() const {
    return patient_turns_ - std::max<std::size_t>(1, patient_turns_ / static_cast<std::size_t>(turn_));
}

void Machine::ask(Searching& state, Time now, Actions& out) {
    const Search::Step step = state.search.next(now);
    wire_.set_rate(step.baud, {}, out);
    if (!step.ask) return;
    std::vector<std::string> lines;
    state.switched = checksums_seen_ || has_checksums();
    if (state.switched)
        lines = wire_.switching_lines(false);
    else if (step.newline_first)
        lines.emplace_back();
    lines.emplace_back(protocol::kAskInfo);
    write(lines, now, out);
}

void Machine::on_event(Searching& state, const protocol::Event& event, std::string_view line, Time now,
                       Actions& out) {
    if (event.service == '#' && event.tag == '?') {
        progress_at_ = now;
        return identify(now, out);
    }
    state.search.heard();
    note_report(event, now);
    // Answers to questions that were asked before belong to no client.
    if (event.service != '#') out.emplace_back(BoardLine{protocol::ParsedLine(line, event), std::nullopt});
}

void Machine::on_error(Searching& state, const protocol::ErrorReply& error, std::string_view, Time now,
                       Actions& out) {
    state.search.heard();
    if (error.code != static_cast<int>(protocol::ErrorCode::kBadChecksum) ||
        std::exchange(state.switched, true))
        return;
    // A program before us left checksums on.
    checksums_seen_ = true;
    auto lines = wire_.switching_lines(false);
    lines.emplace_back(protocol::kAskInfo);
    write(lines, now, out);
}

void Machine::on_time(Searching& state, Time now, Actions& out) {
    if (there_ && now >= state.since + options_.patience) return fall_silent(now, out);
    if (now >= state.search.next_deadline()) ask(state, now, out);
}

Time Machine::deadline(const Searching& state) const {
    const Time next = state.search.next_deadline();
    return there_ ? std::min(next, state.since + options_.patience) : next;
}

}  // namespace asip::session
