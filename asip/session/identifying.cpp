// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "asip/protocol/message.hpp"
#include "asip/session/machine.hpp"

namespace asip::session {

namespace {

// So often a board that seems to be another one is asked again until two answers are equal.
constexpr int kAskedAgain = 3;

}  // namespace

Interview Machine::new_interview(Time now, std::vector<std::string>& lines) {
    const bool protect = options_.checksum == ChecksumPolicy::kAlways ||
                         (options_.checksum == ChecksumPolicy::kAuto && damage_seen_);
    return {banner_services_, protect, now, lines};
}

void Machine::on_event(Identifying& state, const protocol::Event& event, std::string_view line, Time now,
                       Actions& out) {
    std::vector<std::string> lines;
    state.answers = true;
    if (state.interview.on_event(event, now, lines)) {
        state.answers = false;
        progress_at_ = now;
        write(lines, now, out);
        return follow(state, now, out);
    }
    note_report(event, now);
    // Answers to questions that were asked twice belong to no client.
    if (event.service != '#') out.emplace_back(BoardLine{protocol::ParsedLine(line, event), std::nullopt});
}

void Machine::on_error(Identifying& state, const protocol::ErrorReply& error, std::string_view, Time now,
                       Actions& out) {
    std::vector<std::string> lines;
    state.answers = true;
    if (error.code == static_cast<int>(protocol::ErrorCode::kBadChecksum) && !wire_.writes_checksums()) {
        // It still has them on, or has them on again.
        checksums_seen_ = true;
        lines = wire_.switching_lines(false);
        state.interview.repeat(now, lines);
        return write(lines, now, out);
    }
    if (!state.interview.on_error(error, now, lines)) return;
    write(lines, now, out);
    follow(state, now, out);
}

void Machine::on_time(Identifying& state, Time now, Actions& out) {
    // It restarts again and again, and says nothing else.
    if (there_ && now >= progress_at_ + options_.patience) return fall_silent(now, out);
    // Its answer to the search came late, and was read at a rate that it does not have.
    if (!wire_.at_start_rate() && now >= deadline(state) && !std::exchange(state.answers, false))
        return search(now, now, out);
    std::vector<std::string> lines;
    state.interview.on_deadline(now, options_.answer_timeout, lines);
    if (!lines.empty() && (wire_.writes_checksums() || checksums_seen_))
        write(wire_.switching_lines(wire_.writes_checksums()), now, out);
    write(lines, now, out);
    follow(state, now, out);
}

Time Machine::deadline(const Identifying& state) const {
    const Time next = state.interview.next_deadline(options_.answer_timeout);
    return there_ ? std::min(next, progress_at_ + options_.patience) : next;
}

// Without checksums a damaged answer may look like that of another board: only what comes twice is believed.
bool Machine::is_believed(const Identity& found) {
    const int times = unconfirmed_ ? unconfirmed_->times : 0;
    const bool believed = !known_ || wire_.writes_checksums() || same_board(identity_, found) ||
                          times == kAskedAgain || (unconfirmed_ && same_board(unconfirmed_->said, found));
    if (believed)
        unconfirmed_.reset();
    else
        unconfirmed_ = Unconfirmed{found, times + 1};
    return believed;
}

void Machine::follow(Identifying& state, Time now, Actions& out) {
    Interview& interview = state.interview;
    if (interview.progress() == Interview::Progress::kFailed) return search(now, now, out);
    if (interview.progress() != Interview::Progress::kDone) return;
    if (!is_believed(interview.identity())) {
        std::vector<std::string> lines;
        interview = new_interview(now, lines);
        return write(lines, now, out);
    }
    if (interview.identity().extensions.has(protocol::kEcho))
        queue_.use_echo(interview.identity().extensions.has(protocol::kVerifiedFence));
    else
        queue_.use_questions(interview.other_question());
    set_up_line(std::move(interview.identity()), now, out);
}

}  // namespace asip::session
