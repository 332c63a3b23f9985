#include <utility>

#include "asip/protocol/checksum.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/protocol/request.hpp"
#include "asip/session/board_session_impl.hpp"

namespace asip::session {

namespace {

constexpr Duration kBootTime = std::chrono::milliseconds(2500);
// A board that gave up a rate, or was left in the middle of a change, is back at its start rate after this.
constexpr Duration kRateGivenUp = std::chrono::milliseconds(650);
constexpr std::size_t kChecksumBytes = 3;

}  // namespace

// --- link

void BoardSession::Impl::link_up(const LinkTraits& traits, Time now, Actions& out) {
    start_baud_ = traits.baud;
    baud_ = traits.baud;
    reader_.reset();
    checksum_on_ = false;
    no_answer_said_ = false;
    was_silent_ = false;
    counters_.bytes_in = 0;
    suspect_baud_ = 0;
    ready_baud_ = traits.baud;
    link_up_at_ = last_heard_ = now;
    banner_services_.clear();
    rate_change_.forget_bad();
    restore_ = known_;
    search(traits.restarting ? now + kBootTime : now, now, out);
}

void BoardSession::Impl::link_down(Actions& out) {
    state_ = State::kDown;
    rate_change_.cancel();
    std::vector<RequestQueue::End> ended;
    queue_.abandon_in_flight(ended);
    queue_.abandon_waiting(ended);
    report(ended, {}, out);
}

void BoardSession::Impl::set_rate(unsigned baud, std::string why, Actions& out) {
    if (baud == baud_ || !link_has_rates()) return;
    baud_ = baud;
    reader_.reset();
    out.emplace_back(SetLineRate{baud});
    if (!why.empty()) out.emplace_back(LineRateChanged{baud, std::move(why)});
}

void BoardSession::Impl::line_rate_set(bool ok, Time now, Actions& out) {
    if (rate_change_.step() != RateChange::Step::kSwitching) return;
    std::vector<std::string> lines;
    rate_change_.on_rate_set(ok, now, lines);
    write(lines, out);
    follow_rate_change(now, out);
}

void BoardSession::Impl::write(const std::vector<std::string>& lines, Actions& out) {
    if (lines.empty()) return;
    std::string bytes;
    for (const std::string& line : lines) {
        bytes += checksum_on_ && !line.empty() ? protocol::append_checksum(line) : line;
        bytes += '\n';
    }
    counters_.bytes_out += bytes.size();
    out.emplace_back(Write{std::move(bytes)});
}

// --- finding the board

void BoardSession::Impl::search(Time quiet_until, Time now, Actions& out) {
    state_ = was_silent_ ? State::kSilent : State::kSearching;
    rate_change_.cancel();
    reader_.reset();
    std::vector<RequestQueue::End> ended;
    queue_.abandon_in_flight(ended);
    report(ended, now, out);
    search_.start(start_baud_, link_has_rates(), quiet_until, now);
    search_step(now, out);
}

void BoardSession::Impl::search_step(Time now, Actions& out) {
    const Search::Step step = search_.next(now);
    set_rate(step.baud, {}, out);
    if (!step.ask) return;
    const bool with_checksum = std::exchange(checksum_on_, false);
    std::vector<std::string> lines;
    if (step.newline_first) lines.emplace_back();
    lines.emplace_back(protocol::kAskInfo);
    write(lines, out);
    checksum_on_ = with_checksum;
}

void BoardSession::Impl::interview(Time now, Actions& out) {
    state_ = State::kIdentifying;
    checksum_on_ = false;
    if (suspect_baud_ != 0 && suspect_baud_ == baud_) rate_change_.mark_bad(baud_);
    suspect_baud_ = 0;
    if (baud_ == start_baud_ && std::exchange(ready_baud_, baud_) != baud_) {
        ++counters_.resets;
        out.emplace_back(BoardReset{"it is at its start rate again"});
    }
    std::vector<std::string> lines;
    interview_.start(banner_services_, now, lines);
    write(lines, out);
}

void BoardSession::Impl::follow_interview(Time now, Actions& out) {
    if (state_ != State::kIdentifying || rate_change_.busy()) return;
    if (interview_.progress() == Interview::Progress::kFailed) return search(now, now, out);
    if (interview_.progress() == Interview::Progress::kDone) set_up_line(now, out);
}

void BoardSession::Impl::set_up_line(Time now, Actions& out) {
    const Identity& found = interview_.identity();
    queue_.use_echo(found.extensions.has(protocol::kEcho));
    const bool can = link_has_rates() && options_.max_baud != 0 &&
                     found.extensions.has(protocol::kLineRate) && found.extensions.has(protocol::kEcho);
    const unsigned best = can ? rate_change_.best(options_.max_baud) : baud_;
    if (best == baud_) return become_ready(now, out);
    std::vector<std::string> lines;
    rate_change_.start(best, now, lines);
    write(lines, out);
}

void BoardSession::Impl::follow_rate_change(Time now, Actions& out) {
    switch (rate_change_.step()) {
        case RateChange::Step::kSwitching:
            set_rate(rate_change_.baud(), {}, out);
            break;
        case RateChange::Step::kDone:
            out.emplace_back(LineRateChanged{baud_, "stepped up"});
            rate_change_.cancel();
            become_ready(now, out);
            break;
        case RateChange::Step::kFailed:
            rate_change_.cancel();
            if (rate_change_.refused()) return set_up_line(now, out);
            out.emplace_back(LineRateChanged{
                start_baud_, std::to_string(rate_change_.baud()) + " baud does not work here"});
            search(now + kRateGivenUp, now, out);
            break;
        default:
            break;
    }
}

void BoardSession::Impl::become_ready(Time now, Actions& out) {
    const bool changed = !known_ || !same_board(identity_, interview_.identity());
    identity_ = interview_.identity();
    known_ = true;
    no_answer_said_ = true;
    was_silent_ = false;
    state_ = State::kReady;
    ready_baud_ = baud_;
    last_heard_ = now;
    window_garbage_ = 0;
    queue_.restart();
    if (options_.checksum && identity_.extensions.has(protocol::kChecksum) &&
        identity_.extensions.has(protocol::kEcho)) {
        write({protocol::set_checksum(true)}, out);
        checksum_on_ = true;
    }
    queue_.set_line_overhead(checksum_on_ ? kChecksumBytes : 0);
    if (restore_) {
        auto lines = settings_.restore();
        for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
            RequestQueue::Request request;
            request.line = *line;
            queue_.push_front(std::move(request));
        }
    }
    restore_ = true;
    out.emplace_back(Identified{changed});
    pump(now, out);
}

void BoardSession::Impl::board_restarted(std::string why, Time now, Actions& out) {
    ++counters_.resets;
    out.emplace_back(BoardReset{std::move(why)});
    std::vector<RequestQueue::End> ended;
    queue_.abandon_in_flight(ended);
    report(ended, now, out);
    rate_change_.cancel();
    interview(now, out);
}

void BoardSession::Impl::fall_silent(Time now, Actions& out) {
    was_silent_ = true;
    out.emplace_back(BecameSilent{});
    std::vector<RequestQueue::End> ended;
    queue_.abandon_in_flight(ended);
    queue_.abandon_waiting(ended);
    report(ended, now, out);
    search(now, now, out);
}

}  // namespace asip::session
