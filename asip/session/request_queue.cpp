#include "asip/session/request_queue.hpp"

#include <algorithm>

#include "asip/protocol/request.hpp"

namespace asip::session {

namespace {

// Requests without proof are fenced only when the board had nothing else to do: on a 0.4 board the answer to
// a fence keeps the line busy for 6 ms.
constexpr Duration kLazyFence = std::chrono::milliseconds(100);

// Half of what may be in flight: the fence is then back before the other half is used up, and nobody waits
// for it.
constexpr std::size_t kEarlyFence = 24;

constexpr std::string_view kInfoFence = "?";

}  // namespace

bool RequestQueue::Batch::wants_proof() const {
    return items.empty() ||
           std::any_of(items.begin(), items.end(), [](const Item& i) { return i.request.prove; });
}

RequestQueue::Batch* RequestQueue::open_batch() {
    return batches_.empty() || !batches_.back().token.empty() ? nullptr : &batches_.back();
}

bool RequestQueue::conflicts(const Batch& batch, const Request& next) const {
    if (batch.items.empty()) return false;
    if (overhead_ > 0 || next.alone || batch.items.front().request.alone) return true;
    return std::any_of(batch.items.begin(), batch.items.end(), [&](const Item& item) {
        return item.service == next.line[0] && item.tag == next.line[2] && (item.request.prove || next.prove);
    });
}

bool RequestQueue::may_fence() const {
    if (echo_ && overhead_ == 0) return true;
    return std::none_of(batches_.begin(), batches_.end(), [](const Batch& b) { return !b.token.empty(); });
}

std::size_t RequestQueue::fence_bytes() const {
    return (echo_ ? 7 : 4) + overhead_;
}

std::string RequestQueue::next_token() {
    if (!echo_) return std::string(kInfoFence);
    constexpr std::string_view kDigits = "0123456789abcdefghijklmnopqrstuvwxyz";
    token_counter_ = (token_counter_ + 1) % (36 * 36);
    return {kDigits[token_counter_ / 36], kDigits[token_counter_ % 36]};
}

void RequestQueue::close(Batch& batch, Time now, std::vector<std::string>& lines) {
    batch.token = next_token();
    lines.push_back(echo_ ? protocol::echo(batch.token) : std::string(protocol::kAskInfo));
    batch.bytes += fence_bytes();
    in_flight_ += fence_bytes();
    batch.last_sent = now;
}

void RequestQueue::send(Request request, Time now, std::vector<std::string>& lines) {
    if (!open_batch()) batches_.emplace_back();
    Batch& batch = batches_.back();
    const std::size_t bytes = request.line.size() + 1 + overhead_;
    batch.bytes += bytes;
    in_flight_ += bytes;
    batch.last_sent = now;
    lines.push_back(request.line);
    const char service = request.line[0];
    const char tag = request.line[2];
    batch.items.push_back(Item{std::move(request), service, tag, false, false, {}});
}

std::vector<std::string> RequestQueue::pump(Time now) {
    std::vector<std::string> lines;
    if (stalled_ || probe_wanted_) {
        if (batches_.empty()) {
            batches_.emplace_back();
            close(batches_.back(), now, lines);
        }
        probe_wanted_ = false;
        if (stalled_) return lines;
    }
    while (!waiting_.empty()) {
        const Request& next = waiting_.front();
        Batch* const open = open_batch();
        if (open && conflicts(*open, next)) {
            if (!may_fence()) return lines;
            close(*open, now, lines);
            continue;
        }
        if (overhead_ > 0 && !batches_.empty()) return lines;
        const std::size_t bytes = next.line.size() + 1 + overhead_;
        if (in_flight_ + bytes + fence_bytes() > kMaxInFlightBytes && in_flight_ > 0) {
            if (open && may_fence()) close(*open, now, lines);
            return lines;
        }
        Request request = std::move(waiting_.front());
        waiting_.pop_front();
        send(std::move(request), now, lines);
    }
    Batch* const open = open_batch();
    if (!open || !may_fence()) return lines;
    if (open->wants_proof() || in_flight_ >= kEarlyFence || now >= open->last_sent + kLazyFence)
        close(*open, now, lines);
    return lines;
}

void RequestQueue::probe() {
    if (batches_.empty() && waiting_.empty()) probe_wanted_ = true;
}

bool RequestQueue::is_own_question(const protocol::Event& event) {
    // A client may ask `#,?` or `#,E,token` itself; those stand before our fence, and so do their answers.
    for (Batch& batch : batches_) {
        for (Item& item : batch.items) {
            if (item.answered || item.service != '#' || item.tag != event.tag) continue;
            if (event.tag == 'E' && protocol::echo(event.body) != item.request.line) continue;
            item.answered = true;
            return false;
        }
        if (event.tag == '?' ? batch.token == kInfoFence : batch.token == event.body)
            return !batch.token.empty();
    }
    return false;
}

bool RequestQueue::on_event(const protocol::Event& event, std::string_view line, std::vector<End>& ended) {
    const bool fence_like = event.service == '#' && (event.tag == (echo_ ? 'E' : '?'));
    if (fence_like && is_own_question(event)) return on_fence(echo_ ? event.body : kInfoFence, ended);
    if (note_answer(event, line)) return false;
    if (fence_like && !echo_ && stray_ > 0) {
        --stray_;
        return true;
    }
    return false;
}

bool RequestQueue::note_answer(const protocol::Event& event, std::string_view line) {
    for (Batch& batch : batches_) {
        for (Item& item : batch.items) {
            if (item.service != event.service || item.request.answer_tag != event.tag || !item.answer.empty())
                continue;
            item.answer = line;
            return true;
        }
    }
    return false;
}

bool RequestQueue::on_fence(std::string_view token, std::vector<End>& ended) {
    lost_fences_ = 0;
    stalled_ = false;
    while (!batches_.empty()) {
        const bool proven = batches_.front().token == token;
        finish_front(ended, proven);
        if (proven) return true;
    }
    return true;
}

void RequestQueue::finish_front(std::vector<End>& ended, bool proven) {
    Batch batch = std::move(batches_.front());
    batches_.pop_front();
    in_flight_ -= batch.bytes;
    for (Item& item : batch.items) {
        if (item.refused) continue;
        Ending ending = Ending::kTimeout;
        if (proven) ending = item.request.prove ? Ending::kExecuted : Ending::kUnproven;
        ended.push_back(End{std::move(item.request), ending, 0, {}, std::move(item.answer)});
    }
}

void RequestQueue::on_error(const protocol::ErrorReply& error, std::vector<End>& ended) {
    if (batches_.empty()) return;
    auto& items = batches_.front().items;
    auto it = std::find_if(items.begin(), items.end(), [&](const Item& item) {
        return !item.refused && item.service == error.service && item.tag == error.tag;
    });
    const bool nameless =
        error.tag == '?' || error.service == 'Q' || (error.service == '#' && error.tag == 'C');
    if (it == items.end() && nameless && items.size() == 1 && !items.front().refused) it = items.begin();
    if (it == items.end()) return;
    it->refused = true;
    ended.push_back(End{it->request, Ending::kBoardError, error.code, std::string(error.text), {}});
}

void RequestQueue::on_deadline(Time now, Duration answer_timeout, std::vector<End>& ended) {
    if (batches_.empty() || batches_.front().token.empty() ||
        now < batches_.front().last_sent + answer_timeout)
        return;
    ++lost_fences_;
    ++fence_timeouts_;
    stalled_ = true;
    abandon_in_flight(ended);
}

void RequestQueue::abandon_in_flight(std::vector<End>& ended) {
    while (!batches_.empty()) {
        if (batches_.front().token == kInfoFence) ++stray_;
        finish_front(ended, false);
    }
    in_flight_ = 0;
    probe_wanted_ = false;
}

void RequestQueue::abandon_waiting(std::vector<End>& ended) {
    for (Request& request : waiting_)
        ended.push_back(End{std::move(request), Ending::kNotSent, 0, {}, {}});
    waiting_.clear();
}

void RequestQueue::restart() {
    stalled_ = false;
    probe_wanted_ = false;
    stray_ = 0;
    lost_fences_ = 0;
}

std::optional<Time> RequestQueue::next_deadline(Duration answer_timeout) const {
    std::optional<Time> deadline;
    if (!batches_.empty() && !batches_.front().token.empty())
        deadline = batches_.front().last_sent + answer_timeout;
    if (!batches_.empty() && batches_.back().token.empty() && may_fence()) {
        const Time lazy = batches_.back().last_sent + kLazyFence;
        if (!deadline || lazy < *deadline) deadline = lazy;
    }
    return deadline;
}

}  // namespace asip::session
