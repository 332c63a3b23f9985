// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/error_code.hpp"
#include "asip/protocol/request.hpp"
#include "asip/session/machine.hpp"

namespace asip::session {

void Machine::ask(Searching& state, Time now, Actions& out) {
    const Search::Step step = state.search.next(now);
    wire_.set_rate(step.baud, {}, out);
    if (!step.ask) return;
    std::vector<std::string> lines;
    if (checksums_seen_ || has_checksums()) {
        lines = wire_.switching_lines(false);
    } else if (step.newline_first) {
        lines.emplace_back();
    }
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
    if (error.code != static_cast<int>(protocol::ErrorCode::kBadChecksum) || checksums_seen_) return;
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
