#include "asip/protocol/request.hpp"
#include "asip/session/board_session_impl.hpp"

namespace asip::session {

namespace {

constexpr unsigned kLostFenceLimit = 2;

void sooner(std::optional<Time>& deadline, std::optional<Time> other) {
    if (other && (!deadline || *other < *deadline)) deadline = other;
}

}  // namespace

// --- requests

Expected<RequestId, Refusal> BoardSession::Impl::submit(std::string_view line, const RequestOptions& wanted,
                                                        Time now, Actions& out) {
    while (!line.empty() && (line.back() == '\n' || line.back() == '\r'))
        line.remove_suffix(1);
    const auto request = protocol::parse_request(line);
    // The line rate and checksums are between the board and us.
    if (!request || (request->service == '#' && (request->tag == 'B' || request->tag == 'C')))
        return Unexpected<Refusal>(Refusal::kInvalid);
    if (state_ == State::kDown || state_ == State::kSilent || !known_)
        return Unexpected<Refusal>(Refusal::kNoBoard);
    if (queue_.waiting() >= kMaxQueued) return Unexpected<Refusal>(Refusal::kQueueFull);
    RequestQueue::Request queued;
    queued.id = next_id_++;
    queued.line = std::string(line);
    queued.prove = wanted.prove;
    queued.answer_tag = wanted.answer_tag;
    queued.alone = request->service != '#' && !identity_.find_service(request->service);
    const RequestId id = queued.id;
    queue_.push(std::move(queued));
    if (state_ == State::kReady) pump(now, out);
    return id;
}

void BoardSession::Impl::pump(Time now, Actions& out) {
    if (state_ == State::kReady) write(queue_.pump(now), out);
}

void BoardSession::Impl::report(std::vector<RequestQueue::End>& ended, Time now, Actions& out) {
    for (auto& end : ended) {
        if (end.ending == Ending::kExecuted || end.ending == Ending::kUnproven)
            executed(end.request, now, out);
        if (end.ending == Ending::kBoardError) settings_.refused(end.request.line);
        if (end.request.id == 0) continue;
        out.emplace_back(
            Finished{end.request.id, end.ending, end.code, std::move(end.text), std::move(end.answer)});
    }
    ended.clear();
}

void BoardSession::Impl::executed(const RequestQueue::Request& request, Time, Actions&) {
    settings_.executed(request.line);
    const auto mode = parse_mode_request(request.line);
    if (mode && static_cast<std::size_t>(mode->pin) < identity_.pin_modes.size())
        identity_.pin_modes[static_cast<std::size_t>(mode->pin)] = static_cast<protocol::PinMode>(mode->mode);
}

// --- time

void BoardSession::Impl::tick(Time now, Actions& out) {
    if (state_ == State::kDown) return;
    std::vector<std::string> lines;
    if (rate_change_.busy()) {
        rate_change_.on_deadline(now, lines);
        write(lines, out);
        return follow_rate_change(now, out);
    }
    if (state_ == State::kIdentifying) {
        interview_.on_deadline(now, options_.answer_timeout, lines);
        write(lines, out);
        return follow_interview(now, out);
    }
    if (state_ == State::kSearching || state_ == State::kSilent) {
        if (!no_answer_said_ && now >= link_up_at_ + options_.patience) {
            no_answer_said_ = true;
            out.emplace_back(NoAnswer{counters_.bytes_in > 0});
        }
        if (now >= search_.next_deadline()) search_step(now, out);
        return;
    }
    std::vector<RequestQueue::End> ended;
    const auto timeouts = queue_.fence_timeouts();
    queue_.on_deadline(now, options_.answer_timeout, ended);
    report(ended, now, out);
    counters_.fence_timeouts = queue_.fence_timeouts();
    const bool lost_one = counters_.fence_timeouts != timeouts;
    const bool heard_since = now - last_heard_ < options_.answer_timeout;
    if (lost_one && (!heard_since || queue_.lost_fences() >= kLostFenceLimit)) return fall_silent(now, out);
    if (now >= last_heard_ + options_.silence) queue_.probe();
    pump(now, out);
}

std::optional<Time> BoardSession::Impl::next_deadline() const {
    if (state_ == State::kDown) return std::nullopt;
    if (rate_change_.busy()) return rate_change_.next_deadline();
    if (state_ == State::kIdentifying) return interview_.next_deadline(options_.answer_timeout);
    std::optional<Time> deadline;
    if (state_ == State::kReady) {
        sooner(deadline, queue_.next_deadline(options_.answer_timeout));
        if (queue_.idle()) sooner(deadline, last_heard_ + options_.silence);
        return deadline;
    }
    sooner(deadline, search_.next_deadline());
    if (!no_answer_said_) sooner(deadline, link_up_at_ + options_.patience);
    return deadline;
}

}  // namespace asip::session
