// SPDX-License-Identifier: Apache-2.0
#include "asip/session/request_queue.hpp"

#include <algorithm>
#include <utility>

#include "asip/protocol/request.hpp"

namespace asip::session {

namespace {

// Requests without proof are fenced only when the board had nothing else to do: on a 0.4 board the answer to
// a fence keeps the line busy for 6 ms.
constexpr Duration kLazyFence = std::chrono::milliseconds(100);

// Half of what may be in flight: the fence is then back before the other half is used up, and no request
// waits for it.
constexpr std::size_t kEarlyFence = 32;

// What an answer takes on its way through a serial adapter and two programs, more or less.
constexpr Duration kAnswerTime = std::chrono::milliseconds(1);

// A board that writes a long report reads nothing meanwhile.
constexpr Duration kReadsAgainWithin = std::chrono::milliseconds(30);

}  // namespace

void WaitingRequests::push(Request request) {
    earliest_ = std::min(earliest_, request.deadline);
    if (request.urgent) return urgent_.push_back(std::move(request));
    auto& queue = queues_[request.client];
    if (queue.empty()) turns_.push_back(request.client);
    queue.push_back(std::move(request));
    ++size_;
}

std::size_t WaitingRequests::size_of(ClientId client) const {
    const auto queue = queues_.find(client);
    return queue == queues_.end() ? 0 : queue->second.size();
}

bool WaitingRequests::changes_line() const {
    return std::any_of(own_.begin(), own_.end(), [](const Request& own) { return own.changes_line(); });
}

const Request& WaitingRequests::front() const {
    if (!urgent_.empty()) return urgent_.front();
    return own_.empty() ? queues_.find(turns_.front())->second.front() : own_.front();
}

Request WaitingRequests::pop() {
    for (auto* first : {&urgent_, &own_}) {
        if (first->empty()) continue;
        Request request = std::move(first->front());
        first->pop_front();
        return request;
    }
    const ClientId client = turns_.front();
    const auto queue = queues_.find(client);
    Request request = std::move(queue->second.front());
    queue->second.pop_front();
    row_went_ = in_row(client);
    const auto row = rows_.find(request.service());
    if (request.more_follow)
        rows_[request.service()] = {client, request.deadline};
    else if (row != rows_.end() && row->second.client == client)
        rows_.erase(row);
    turns_.pop_front();
    if (queue->second.empty())
        queues_.erase(queue);
    else
        turns_.push_back(client);
    if (--size_ == 0 && urgent_.empty()) earliest_ = Time::max();
    return request;
}

Time WaitingRequests::earliest_deadline() const {
    Time earliest = earliest_;
    for (const auto& [service, row] : rows_)
        earliest = std::min(earliest, row.until);
    return earliest;
}

std::vector<Request> WaitingRequests::take_expired(Time now) {
    std::vector<Request> expired;
    std::erase_if(rows_, [&](const auto& row) { return now >= row.second.until; });
    if (now < earliest_) return expired;
    earliest_ = Time::max();
    const auto sort_out = [&](std::deque<Request>& queue) {
        std::deque<Request> kept;
        for (Request& request : queue) {
            if (now >= request.deadline) {
                expired.push_back(std::move(request));
            } else {
                earliest_ = std::min(earliest_, request.deadline);
                kept.push_back(std::move(request));
            }
        }
        queue = std::move(kept);
    };
    sort_out(urgent_);
    const std::size_t urgent = expired.size();
    for (auto& [client, queue] : queues_)
        sort_out(queue);
    size_ -= expired.size() - urgent;
    std::erase_if(queues_, [](const auto& entry) { return entry.second.empty(); });
    std::erase_if(turns_, [&](ClientId client) { return !queues_.contains(client); });
    return expired;
}

std::vector<Request> WaitingRequests::take_queued() {
    std::vector<Request> queued;
    for (auto& [client, queue] : queues_)
        for (Request& request : queue)
            queued.push_back(std::move(request));
    queues_.clear();
    turns_.clear();
    rows_.clear();
    size_ = 0;
    return queued;
}

std::vector<Request> WaitingRequests::take_all() {
    std::vector<Request> all = take_queued();
    for (Request& request : urgent_)
        all.push_back(std::move(request));
    *this = WaitingRequests{};
    return all;
}

std::size_t RequestQueue::fence_bytes() const {
    const std::size_t line =
        fences_.echo() ? protocol::kAskInfo.size() + Fences::kTokenBytes + 1 : protocol::kAskInfo.size();
    return line + 1 + checksum_bytes_;
}

bool RequestQueue::next_is_too_long_for(std::size_t checksum_bytes) const {
    if (waiting_.empty()) return false;
    // A board that names the longest request has room for its checksum; the others have one buffer for all.
    const bool named = longest_request_ > protocol::kUsualRequestBytes;
    return !named && waiting_.front().line.size() + 1 + checksum_bytes > kReceiveBufferBytes;
}

bool RequestQueue::switching_line() const {
    return in_flight_.is_barrier() || waiting_.changes_line();
}

bool RequestQueue::urgent_while_stalled() const {
    return stalled_ && waiting_.urgent() > 0 && in_flight_.bytes() <= kEarlyFence;
}

bool RequestQueue::may_fence(Time now) const {
    if (in_flight_.has_open_batch() && !in_flight_.may_close(now)) return false;
    return fences_.echo() || !in_flight_.fence_out();
}

void RequestQueue::close(Time now, std::vector<std::string>& lines) {
    Fence fence = fences_.next();
    if (!fences_.echo() && in_flight_.holds_question(fence.line)) fence = fences_.next_but(fence.line);
    lines.push_back(fence.line);
    fence.verifies = fences_.verified() && std::exchange(digest_known_, true);
    in_flight_.close(std::move(fence), fence_bytes(), now);
}

void RequestQueue::look_for_owed(Time now) {
    if (now < in_flight_.look_at() || in_flight_.fence_out() || probe_wanted_) return;
    in_flight_.looked();
    probe_wanted_ = true;
}

void RequestQueue::send_probe(Time now, std::vector<std::string>& lines) {
    if (!stalled_ && !probe_wanted_) return;
    if (in_flight_.has_open_batch() ? may_fence(now) : !in_flight_.fence_out()) {
        close(now, lines);
        probe_wanted_ = false;
    }
}

// A value that comes before its fence may be one of before: the last of reports that were turned off, or what
// another was waiting for. A board that answers at once sends no other, so this is over first.
bool RequestQueue::settles_first(const Request& next, const SelfReports& reports, Time now) {
    if (next.answer_tag == 0 || next.is_question()) return false;
    const bool ending = in_flight_.turns_reports_off(next.service());
    const Time owed = in_flight_.owed_until(next, now);
    const bool is_owed = owed != Time::min();
    const Time over = std::max(ending ? now : reports.until, owed);
    if (over == Time::min() || over == Time::max()) return false;
    if (over > now) {
        if (over > std::max(next.deadline - next.answer_time, now + (next.deadline - now) / 2)) return false;
        settled_at_ = std::min(settled_at_, over);
    }
    if (is_owed && !in_flight_.fence_out()) {
        const Time look = std::min(over, in_flight_.see_again());
        probe_wanted_ = probe_wanted_ || look <= now;
        if (look > now) settled_at_ = std::min(settled_at_, look);
    }
    return over > now || ending || is_owed;
}

bool RequestQueue::next_may_go(Time now, std::vector<std::string>& lines) {
    const Request& next = waiting_.front();
    if (next_is_too_long_for(checksum_bytes_) || now >= next.deadline ||
        ((stalled_ || held_back_) && !next.urgent))
        return false;
    // A value that is on its way keeps its checksum.
    if (in_flight_.awaits_values() && next.line == protocol::set_checksum(false)) return false;
    // From its answer on it is known what the board's digest begins with.
    if (fences_.verified() && !digest_known_ && !in_flight_.has_open_batch()) close(now, lines);
    if (in_flight_.has_open_batch() && in_flight_.conflicts(next, fences_.verified())) {
        if (!may_fence(now)) return false;
        close(now, lines);
    }
    if (in_flight_.empty()) return true;
    // What has to be proven goes with its fence: an outage between them would go unnoticed.
    if (!next.urgent && !fences_.echo() && next.prove && in_flight_.fence_out()) return false;
    const bool fits = in_flight_.bytes() + wire_bytes(next) + next.bytes_behind + fence_bytes() <= room();
    const bool joins =
        fits && !next.changes_line() && !in_flight_.is_barrier() && !fences_.is_fence_question(next.line);
    fills_batch_ = !fits && may_fill_batch(now);
    if (!joins && !fills_batch_ && in_flight_.has_open_batch() && may_fence(now)) close(now, lines);
    return joins;
}

// Where the line is faster than answers are on their way, a full batch at a time gets more requests through
// than small ones behind each other: they need a fence each.
bool RequestQueue::may_fill_batch(Time now) const {
    return fences_.verified() && byte_time_ * static_cast<Duration::rep>(kReceiveBufferBytes) < kAnswerTime &&
           in_flight_.has_open_batch() && in_flight_.fence_out() && in_flight_.close_after() == Time{} &&
           now < in_flight_.last_sent() + kLazyFence;
}

void RequestQueue::send(Request request, bool reports, Time now, std::vector<std::string>& lines) {
    const std::size_t bytes = wire_bytes(request);
    Time close_after{};
    if (in_flight_.bytes() + bytes + fence_bytes() > room())
        close_after = now + byte_time_ * static_cast<Duration::rep>(bytes) + kReadsAgainWithin;
    lines.push_back(request.line);
    const bool doubted = request.urgent && !fences_.echo() && in_flight_.fence_out();
    if (checksum_bytes_ == 0)
        request.line.erase(request.line.find_last_not_of(' ') + 1);  // as the board reads it
    const bool behind_fence = in_flight_.add(std::move(request), bytes, reports, close_after, now);
    if (doubted) in_flight_.doubt_last();
    if (behind_fence && may_fence(now)) close(now, lines);
}

void RequestQueue::send_last_fence(Time now, std::vector<std::string>& lines) {
    if (!in_flight_.has_open_batch() || fills_batch_ || !may_fence(now)) return;
    if (in_flight_.open_batch_wants_proof() || in_flight_.bytes() >= kEarlyFence ||
        now >= in_flight_.last_sent() + kLazyFence)
        close(now, lines);
}

InFlight::Meaning RequestQueue::on_event(const protocol::Event& event, const protocol::ParsedLine& line,
                                         Time now, std::vector<RequestEnd>& ended) {
    const auto batches = in_flight_.batches();
    auto meaning = in_flight_.on_event(event, line, now, ended);
    if (in_flight_.batches() < batches) {
        lost_fences_ = 0;
        stalled_ = in_flight_.overdue();
    }
    return meaning;
}

InFlight::Meaning RequestQueue::on_error(const protocol::ErrorReply& error) {
    return in_flight_.on_error(error, checksum_bytes_ > 0);
}

void RequestQueue::on_time(Time now, Duration answer_timeout, std::vector<RequestEnd>& ended) {
    if (now >= settled_at_) settled_at_ = Time::max();
    if (now >= waiting_.earliest_deadline())
        for (Request& request : waiting_.take_expired(now))
            ended.push_back({std::move(request), Ending::kNotSent, NotSent::kDeadline});
    in_flight_.expire(now, ended);
    const unsigned lost = in_flight_.mark_overdue(now, answer_timeout);
    if (lost == 0) return;
    lost_fences_ += 1;
    fence_timeouts_ += lost;
    stalled_ = true;
}

void RequestQueue::abandon_in_flight(Ending ending, std::vector<RequestEnd>& ended) {
    in_flight_.end_all(ending, ended);
    probe_wanted_ = false;
}

void RequestQueue::abandon_waiting(std::vector<RequestEnd>& ended) {
    for (Request& request : waiting_.take_all())
        ended.push_back({std::move(request), Ending::kNotSent, NotSent::kBoardGone});
}

void RequestQueue::cancel_waiting(std::vector<RequestEnd>& ended) {
    for (Request& request : waiting_.take_queued())
        ended.push_back({std::move(request), Ending::kNotSent, NotSent::kStopped});
}

void RequestQueue::restart() {
    waiting_.forget_own();
    stalled_ = false;
    probe_wanted_ = false;
    lost_fences_ = 0;
    forget_digest();
}

void RequestQueue::probe() {
    if (in_flight_.empty() && waiting_.empty()) probe_wanted_ = true;
}

Time RequestQueue::next_deadline(Duration answer_timeout) const {
    Time deadline = std::min(waiting_.earliest_deadline(), in_flight_.next_deadline(answer_timeout));
    deadline = std::min(deadline, settled_at_);
    if (!in_flight_.has_open_batch() || !(fences_.echo() || !in_flight_.fence_out())) return deadline;
    const Time fence =
        in_flight_.close_after() != Time{} ? in_flight_.close_after() : in_flight_.last_sent() + kLazyFence;
    return std::min(deadline, fence);
}

}  // namespace asip::session
