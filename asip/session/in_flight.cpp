// SPDX-License-Identifier: Apache-2.0
#include "asip/session/in_flight.hpp"

#include <algorithm>
#include <utility>

#include "asip/protocol/message.hpp"
#include "asip/protocol/request.hpp"

namespace asip::session {

namespace {

constexpr std::size_t kMaxLostTokens = 64;
constexpr std::size_t kMaxUnclear = 8;

bool answers_question(const protocol::Event& event, const Request& request) {
    if (event.service != request.service() || event.tag != request.tag()) return false;
    return event.service != '#' || event.tag != 'E' || protocol::echo(event.body) == request.line;
}

bool names(const protocol::ErrorReply& error, const Request& request) {
    if (error.service == request.service() && error.tag == request.tag()) return true;
    // A service that the board does not have: the error names no tag, and on some boards not even the letter.
    return request.alone && error.code == static_cast<int>(protocol::ErrorCode::kInvalidService) &&
           error.tag == '?' && (error.service == 'Q' || error.service == request.service());
}

// Nothing else can come of two requests between which the line end was lost.
bool is_of_syntax(const protocol::ErrorReply& error) {
    return error.code == static_cast<int>(protocol::ErrorCode::kUnknownRequest) ||
           error.code == static_cast<int>(protocol::ErrorCode::kBadArgument);
}

}  // namespace

bool InFlight::open_batch_wants_proof() const {
    const auto& items = batches_.back().items;
    return items.empty() || std::any_of(items.begin(), items.end(), [](const Item& item) {
               return item.request.prove || item.wants_value();
           });
}

bool InFlight::fence_out() const {
    return std::any_of(batches_.begin(), batches_.end(),
                       [](const Batch& batch) { return batch.fence.sent() && !batch.overdue; });
}

bool InFlight::conflicts(const Request& next, bool verified) const {
    const auto& items = batches_.back().items;
    if (items.empty()) return false;
    if (next.alone || items.front().request.alone) return true;
    const auto plain = [](const Request& one) { return one.answer_tag == 0 && !one.is_question(); };
    return std::any_of(items.begin(), items.end(), [&](const Item& item) {
        const Request& one = item.request;
        if (one.service() != next.service() || one.tag() != next.tag()) return false;
        // An error goes to its client at once, so it must be known whose it is before the digest comes.
        if (one.client != next.client || (one.id == 0) != (next.id == 0)) return true;
        if (!one.prove && !next.prove) return false;
        return !verified || !plain(one) || !plain(next);
    });
}

bool InFlight::holds_question(std::string_view line) const {
    return std::any_of(batches_.begin(), batches_.end(), [&](const Batch& batch) {
        return batch.fence.line == line ||
               std::any_of(batch.items.begin(), batch.items.end(),
                           [&](const Item& item) { return item.asked && item.request.line == line; });
    });
}

bool InFlight::is_barrier() const {
    return !batches_.empty() && !batches_.back().items.empty() &&
           batches_.back().items.front().request.changes_line();
}

bool InFlight::add(Request request, std::size_t bytes, bool reports, Time close_after, Time now) {
    if (!has_open_batch()) batches_.emplace_back();
    Batch& batch = batches_.back();
    batch.bytes += bytes;
    bytes_ += bytes;
    batch.last_sent = now;
    batch.close_after = close_after;
    earliest_ = std::min(earliest_, request.deadline);
    Item item;
    item.asked = request.is_question();
    item.number = next_number_++;
    item.follows_owed = std::any_of(owed_.begin(), owed_.end(), [&](const Owed& owed) {
        return owed.service == request.service() && owed.tag == request.answer_tag;
    });
    item.behind_fence = item.follows_owed || reports || changes_period(request.service());
    item.request = std::move(request);
    batch.items.push_back(std::move(item));
    return batch.items.back().behind_fence;
}

void InFlight::close(Fence fence, std::size_t bytes, Time now) {
    if (!has_open_batch()) batches_.emplace_back();
    Batch& batch = batches_.back();
    if (batch.close_after != Time{}) {
        // That long ago that the board has read it.
        bytes_ -= batch.bytes;
        batch.bytes = 0;
    }
    batch.fence = std::move(fence);
    batch.number = next_number_++;
    batch.bytes += bytes;
    bytes_ += bytes;
    batch.last_sent = now;
}

InFlight::Item* InFlight::find_question(const protocol::Event& event) {
    for (Batch& batch : batches_)
        for (Item& item : batch.items)
            if (item.asked && answers_question(event, item.request)) return &item;
    return nullptr;
}

InFlight::Meaning InFlight::on_event(const protocol::Event& event, const protocol::ParsedLine& line, Time now,
                                     std::vector<RequestEnd>& ended) {
    Meaning meaning;
    if (Item* const item = is_question(event.service, event.tag) ? find_question(event) : nullptr) {
        item->asked = false;
        if (item->request.answer_tag == event.tag) {
            item->answer = line;
            item->has_value = true;
        }
        if (item->request.id != 0) meaning.owner = item->request.client;
        return meaning;
    }
    std::optional<std::size_t> found;
    std::size_t matches = 0;
    for (std::size_t i = 0; i < batches_.size(); ++i) {
        if (!batches_[i].fence.is_answered_by(event)) continue;
        if (!found) found = i;
        ++matches;
    }
    if (found) {
        meaning.is_fence = true;
        meaning.contradicts = !settle_errors(batches_[*found], event);
        fences_back(*found, matches > 1 || meaning.contradicts, now, ended);
        return meaning;
    }
    meaning.is_fence = is_late(event);
    if (!meaning.is_fence) meaning.is_value = note_value(event, line, ended);
    return meaning;
}

void InFlight::fences_back(std::size_t number, bool ambiguous, Time now, std::vector<RequestEnd>& ended) {
    if (std::exchange(stood_still_, false)) goes_on(now);
    for (std::size_t i = 0; i < number; ++i) {
        remember_lost(batches_.front().fence);
        Batch lost = std::move(batches_.front());
        batches_.pop_front();
        finish(std::move(lost), true, now, ended);
        for (Awaiting& awaiting : awaiting_)
            awaiting.item.doubted = true;
    }
    Batch batch = std::move(batches_.front());
    batches_.pop_front();
    if (!ambiguous) {
        see_running(batch, now);
        forget_owed(batch, now);
    }
    finish(std::move(batch), number > 0 || ambiguous, now, ended);
}

void InFlight::finish(Batch batch, bool missing, Time now, std::vector<RequestEnd>& ended) {
    bytes_ -= batch.bytes;
    for (Item& item : batch.items) {
        if (item.ended) {
            // It was executed after its end. No client is told, but what it set holds.
            if (missing || item.doubted || item.suspected || item.error) continue;
            item.request.id = 0;
            ended.push_back({std::move(item.request), Ending::kExecuted});
            continue;
        }
        if (missing || ((item.doubted || item.suspected) && !item.error)) {
            end(item, Ending::kDoubt, ended);
        } else if (item.error) {
            end(item, Ending::kBoardError, ended);
        } else if (item.value_error) {
            end_without_value(item, Time::max(), ended);
        } else if (item.wants_value() && !item.has_value) {
            const Time latest = now + item.request.answer_time;
            const Time deadline = item.request.deadline;
            awaiting_.push_back({std::move(item), std::min(deadline, latest), latest});
        } else {
            end(item, item.request.prove ? Ending::kExecuted : Ending::kUnproven, ended);
        }
    }
}

void InFlight::end(Item& item, Ending ending, std::vector<RequestEnd>& ended, Time sent_by) {
    item.ended = true;
    note_owed(item, ending, sent_by);
    RequestEnd end{std::move(item.request), ending};
    // What is left of it is still compared with what the board answers.
    item.request.line = end.request.line;
    if (ending == Ending::kBoardError) {
        end.code = item.error->first;
        end.text = item.error->second;
    }
    if (ending == Ending::kExecuted) end.answer = std::move(item.answer);
    ended.push_back(std::move(end));
}

InFlight::Meaning InFlight::on_error(const protocol::ErrorReply& error, bool checksums) {
    Meaning meaning;
    meaning.unexplained = true;
    if (batches_.empty()) return error_for_value(error);
    Batch& batch = batches_.front();
    std::vector<std::size_t> named;
    bool behind = false;
    for (std::size_t i = 0; i < batch.items.size(); ++i) {
        Item& item = batch.items[i];
        // What was sent behind it may have been read as a part of it.
        if (behind) item.doubted = true;
        if (item.error || !names(error, item.request)) continue;
        named.push_back(i);
        behind = behind || (!checksums && is_of_syntax(error));
    }
    if (named.empty()) return error_for_value(error);
    const Request& first = batch.items[named.front()].request;
    const bool one_client = std::all_of(named.begin(), named.end(), [&](std::size_t i) {
        const Request& request = batch.items[i].request;
        return request.id != 0 && request.client == first.client;
    });
    if (one_client) meaning.owner = first.client;
    // The board had accepted this before, so the line changed it; a digest would tell what else it changed.
    meaning.unexplained = first.id == 0 && !batch.fence.verifies;
    if (named.size() == 1) {
        batch.items[named.front()].error.emplace(error.code, std::string(error.text));
        return meaning;
    }
    for (const std::size_t i : named)
        batch.items[i].suspected = true;
    if (batch.unclear.size() == kMaxUnclear) {
        for (const std::size_t i : named)
            batch.items[i].doubted = true;
        return meaning;
    }
    batch.unclear.push_back({error.code, std::string(error.text), std::move(named)});
    return meaning;
}

void InFlight::doubt() {
    for (Batch& batch : batches_)
        for (Item& item : batch.items)
            item.doubted = true;
    for (Awaiting& awaiting : awaiting_)
        awaiting.item.doubted = true;
}

void InFlight::expire(Time now, std::vector<RequestEnd>& ended) {
    for (Awaiting& awaiting : awaiting_)
        if (now >= awaiting.until) end_without_value(awaiting.item, awaiting.latest, ended);
    std::erase_if(awaiting_, [](const Awaiting& awaiting) { return awaiting.item.ended; });
    if (now < earliest_) return;
    earliest_ = Time::max();
    for (Batch& batch : batches_) {
        for (Item& item : batch.items) {
            if (item.ended) continue;
            if (now < item.request.deadline) {
                earliest_ = std::min(earliest_, item.request.deadline);
                continue;
            }
            end(item,
                item.error     ? Ending::kBoardError
                : item.doubted ? Ending::kDoubt
                               : Ending::kTimeout,
                ended);
        }
    }
}

unsigned InFlight::mark_overdue(Time now, Duration answer_timeout) {
    unsigned count = 0;
    for (Batch& batch : batches_) {
        if (batch.overdue || !batch.fence.sent() || now < batch.last_sent + answer_timeout) continue;
        batch.overdue = stood_still_ = true;
        bytes_ -= std::exchange(batch.bytes, 0u);
        ++count;
    }
    return count;
}

void InFlight::end_all(Ending ending, std::vector<RequestEnd>& ended) {
    for (Batch& batch : batches_) {
        if (batch.fence.sent()) remember_lost(batch.fence);
        for (Item& item : batch.items)
            if (!item.ended) end(item, ending, ended);
    }
    for (Awaiting& awaiting : awaiting_)
        end(awaiting.item, Ending::kNoValue, ended);
    batches_.clear();
    awaiting_.clear();
    stood_still_ = true;
    bytes_ = 0;
    earliest_ = Time::max();
}

bool InFlight::is_late(const protocol::Event& event) const {
    const auto token = fence_token(event);
    return !token.empty() && std::find(lost_tokens_.begin(), lost_tokens_.end(), token) != lost_tokens_.end();
}

void InFlight::remember_lost(const Fence& fence) {
    if (fence.token.empty()) return;
    lost_tokens_.push_back(fence.token);
    if (lost_tokens_.size() > kMaxLostTokens) lost_tokens_.pop_front();
}

Time InFlight::next_deadline(Duration answer_timeout) const {
    Time deadline = earliest_;
    for (const Awaiting& awaiting : awaiting_)
        deadline = std::min(deadline, awaiting.until);
    for (const Batch& batch : batches_)
        if (batch.fence.sent() && !batch.overdue) {
            deadline = std::min(deadline, batch.last_sent + answer_timeout);
            break;
        }
    return deadline;
}

}  // namespace asip::session
