// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "asip/protocol/request.hpp"
#include "asip/session/machine.hpp"

namespace asip::session {

namespace {

constexpr Duration kGarbageWindow = std::chrono::seconds(10);
constexpr unsigned kGarbageLimit = 3;
// Fences lost in a row after which the board is asked anew what it is.
constexpr unsigned kLostFenceLimit = 3;
// The board reports by itself as long as the last report is not older.
constexpr Duration kReportsLast = std::chrono::seconds(1);
// Between two attempts to restore what clients had set.
constexpr Duration kRestoreAgain = std::chrono::milliseconds(100);

}  // namespace

void Machine::on_event(Ready&, const protocol::Event& event, std::string_view line, Time now, Actions& out) {
    if (leaving_ && leaving_->asked && event.service == '#' && event.tag == 'B') return has_left();
    if (!is_well_formed(event) || queue_.refutes(event)) {
        note_garbage("not the answer to what was asked", line, out);
        damaged();
    }
    std::vector<RequestEnd> ended;
    protocol::ParsedLine parsed(line, event);
    const auto meaning = queue_.on_event(event, parsed, now, ended);
    if (meaning.contradicts) {
        ++counters_.contradictions;
        damaged();
    }
    if (!meaning.is_fence) {
        if (!meaning.owner && !meaning.is_value) note_report(event, now);
        out.emplace_back(BoardLine{std::move(parsed), meaning.owner});
    }
    report(ended, out);
    pump(now, out);
}

void Machine::on_error(Ready& state, const protocol::ErrorReply& error, std::string_view line, Time now,
                       Actions& out) {
    const auto meaning = queue_.on_error(error);
    out.emplace_back(BoardLine{protocol::ParsedLine(line, error), meaning.owner});
    if (!meaning.unexplained) return;
    ++counters_.unexplained_errors;
    queue_.doubt();
    damaged();
    on_time(state, now, out);
}

void Machine::damaged() {
    damage_seen_ = true;
}

void Machine::on_garbage(Ready& state, Time now, Actions& out) {
    damaged();
    if (wire_.at_start_rate()) return pump(now, out);
    // At a fast rate, garbage means that the board restarted and talks at its start rate, or that the rate is
    // too fast.
    if (now > state.garbage_since + kGarbageWindow) {
        state.garbage_since = now;
        state.garbage = 0;
    }
    if (++state.garbage < kGarbageLimit || leaving_) {
        queue_.probe();
        return pump(now, out);
    }
    suspect_baud_ = wire_.baud();
    search(now, now, out);
}

void Machine::on_time(Ready&, Time now, Actions& out) {
    if (queue_.stalled()) damaged();
    if (!leaving_ && queue_.lost_fences() >= kLostFenceLimit) return search(now, now, out);
    if (now >= last_byte_ + options_.silence) queue_.probe();
    renew_missing(now);
    pump(now, out);
}

Time Machine::deadline(const Ready&) const {
    const bool waits = restore_again_ && !leaving_ && !queue_.in_flight();
    const Time restores = waits ? restored_again_at_ + kRestoreAgain : Time::max();
    return std::min({queue_.idle() ? last_byte_ + options_.silence : Time::max(), next_renewal(), restores});
}

void Machine::pump(Time now, Actions& out) {
    if (leaving_) return leave_once_quiet(now, out);
    switch_checksums();
    // Behind all that is under way, so that it is the latest of what clients had set.
    const bool restores = restore_again_ && now >= restored_again_at_ + kRestoreAgain;
    if (restores && !queue_.in_flight()) {
        restore_settings();
        restored_again_at_ = now;
        restore_again_ = false;
    }
    queue_.hold_back(restores && restore_again_);
    queue_.set_reporting(!reports_.empty() && now < last_report_ + kReportsLast);
    if ((queue_.will_resynchronise() || queue_.urgent_while_stalled()) && has_checksums() &&
        (wire_.writes_checksums() || wants_checksums())) {
        write(wire_.switching_lines(wants_checksums()), now, out);
        queue_.forget_digest();
    }
    write(queue_.pump(now, [&](const Request& request) { return self_reports(request); }), now, out);
    queue_.set_checksum_bytes(wire_.writes_checksums() ? Wire::kChecksumBytes : 0);
}

void Machine::switch_checksums() {
    if (queue_.switching_line()) return;
    const bool wanted = wants_checksums() && !queue_.next_is_too_long_for(Wire::kChecksumBytes);
    if (wanted == wire_.writes_checksums()) return;
    Request request;
    request.line = protocol::set_checksum(wanted);
    request.alone = true;
    queue_.waiting().push_own(std::move(request));
}

SelfReports Machine::self_reports(const Request& request) const {
    if (request.answer_tag == 0 || request.is_question()) return {};
    SelfReports reports;
    const auto known = std::find_if(reports_.begin(), reports_.end(), [&](const Report& report) {
        return report.service == request.service() && report.tag == request.answer_tag;
    });
    if (known != reports_.end()) reports.until = known->last + kReportsLast;
    for (const NewPeriod& period : new_periods_) {
        if (period.service != request.service()) continue;
        reports.until = period.in_doubt ? Time::max() : std::max(reports.until, period.at + kReportsLast);
    }
    const auto period = settings_.period(request.service());
    if (period) reports.every = std::chrono::milliseconds(*period);
    if (period ? *period > 0 : known != reports_.end()) reports.until = Time::max();
    return reports;
}

// Notes an event that comes without a request.
void Machine::note_report(const protocol::Event& event, Time now) {
    if (event.service == '#') return;
    last_report_ = now;
    renew_behind(event, now);
    const auto known = std::find_if(reports_.begin(), reports_.end(), [&](const Report& report) {
        return report.service == event.service && report.tag == event.tag;
    });
    if (known == reports_.end())
        reports_.push_back({event.service, event.tag, now});
    else
        known->last = now;
}

}  // namespace asip::session
