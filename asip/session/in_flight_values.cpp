// SPDX-License-Identifier: Apache-2.0
// The values that requests ask for: which event is whose.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "asip/session/in_flight.hpp"

namespace asip::session {

namespace {

constexpr std::size_t kMaxOwed = 16;

}  // namespace

bool InFlight::awaits_value_of(const Request& next) const {
    if (next.answer_tag == 0 || next.is_question()) return false;
    const auto waits = [&](const Item& item) {
        return !item.ended && !item.has_value && item.request.service() == next.service() &&
               item.request.answer_tag == next.answer_tag;
    };
    return any_awaiting(waits) || any_sent(waits);
}

bool InFlight::changes_period(char service) const {
    return any_sent(
        [&](const Item& item) { return item.request.tag() == 'A' && item.request.service() == service; });
}

bool InFlight::turns_reports_off(char service) const {
    return any_sent([&](const Item& item) {
        const std::string_view line = item.request.line;
        return item.request.tag() == 'A' && item.request.service() == service &&
               line.substr(std::min(line.size(), std::string_view("D,A,").size())) == "0";
    });
}

bool InFlight::refutes(const protocol::Event& event) const {
    const auto refuses = [&](const Item& item) {
        const Request& request = item.request;
        return !item.ended && !item.has_value && request.is_answer && request.answer_tag == event.tag &&
               request.service() == event.service && !request.is_answer(event);
    };
    return any_awaiting(refuses) || any_sent(refuses);
}

void InFlight::end_without_value(Item& item, Time sent_by, std::vector<RequestEnd>& ended) {
    if (item.value_error) item.error = std::move(item.value_error);
    const bool known = item.error && !item.doubted;
    end(item, known ? Ending::kBoardError : Ending::kNoValue, ended, sent_by);
}

// An event that comes late must not be taken for the answer to a younger request.
void InFlight::note_owed(const Item& item, Ending ending, Time sent_by) {
    if (!item.wants_value() || item.has_value || item.request.is_question()) return;
    if (ending == Ending::kExecuted || ending == Ending::kBoardError || owed_.size() >= kMaxOwed) return;
    owed_.push_back({item.number, item.request.service(), item.request.answer_tag, sent_by, next_number_,
                     item.request.answer_time});
}

// A board that stood still did not measure meanwhile.
void InFlight::goes_on(Time now) {
    for (Awaiting& one : awaiting_) {
        one.latest = std::max(one.latest, now + one.item.request.answer_time);
        one.until = std::min(one.item.request.deadline, one.latest);
    }
}

// A fence that comes at once shows that the board runs, not that it ran all the time since the one before: it
// may have stood still between measuring and sending.
void InFlight::see_running(const Batch& batch, Time now) {
    const bool seen = now - std::exchange(last_back_, now) <= longest_gap();
    usual_way_ += (now - batch.last_sent - usual_way_) / 8;
    if (seen) return;
    for (Owed& one : owed_)
        one.sent_by = std::max(one.sent_by, now + one.answer_time);
}

// What was on the way before a fence has come when the fence is back. What was sent before it was executed by
// then, or never is.
void InFlight::forget_owed(const Batch& batch, Time now) {
    std::erase_if(
        owed_, [&](const Owed& one) { return one.sent_by <= batch.last_sent && one.ended <= batch.number; });
    for (Owed& one : owed_)
        if (one.sent_by == Time::max() && one.ended <= batch.number) one.sent_by = now + one.answer_time;
}

Time InFlight::look_at() const {
    const bool looks =
        std::any_of(owed_.begin(), owed_.end(), [](const Owed& one) { return one.looks > 0; }) ||
        any_awaiting([](const Item& item) { return item.follows_owed; });
    return looks ? see_again() : Time::max();
}

void InFlight::looked() {
    for (Owed& one : owed_)
        one.looks -= one.looks > 0 ? 1 : 0;
}

Time InFlight::owed_until(const Request& next, Time now) const {
    Time until = Time::min();
    for (const Owed& one : owed_) {
        if (one.service != next.service() || one.tag != next.answer_tag) continue;
        until = std::max(until, one.sent_by == Time::max() ? now + one.answer_time : one.sent_by);
    }
    return until;
}

// An event answers the oldest request for it, or one that ended before it came.
bool InFlight::settle_owed(const protocol::Event& event, std::uint64_t oldest_taker) {
    const auto owed = std::find_if(owed_.begin(), owed_.end(), [&](const Owed& one) {
        return one.service == event.service && one.tag == event.tag && one.number < oldest_taker;
    });
    if (owed == owed_.end()) return false;
    owed_.erase(owed);
    return true;
}

bool InFlight::note_value(const protocol::Event& event, const protocol::ParsedLine& line,
                          std::vector<RequestEnd>& ended) {
    const auto answers = [&](const Item& item) {
        return item.request.answer_tag == event.tag && item.request.service() == event.service;
    };
    constexpr auto kNone = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t oldest_taker = kNone;
    const auto take = [&](Item& item) {
        item.has_value = true;
        item.answer = line;
        oldest_taker = std::min(oldest_taker, item.number);
    };
    for (Awaiting& awaiting : awaiting_) {
        if (!answers(awaiting.item)) continue;
        take(awaiting.item);
        end(awaiting.item, awaiting.item.doubted ? Ending::kDoubt : Ending::kExecuted, ended);
    }
    std::erase_if(awaiting_, [](const Awaiting& awaiting) { return awaiting.item.ended; });
    bool waits = oldest_taker != kNone;
    for (Batch& batch : batches_) {
        for (Item& item : batch.items) {
            if (oldest_taker != kNone || item.ended || !answers(item) || item.has_value) continue;
            waits = true;
            if (!item.behind_fence) take(item);
        }
    }
    return settle_owed(event, oldest_taker) || waits;
}

// The event could not be measured: an error with its tag comes in its place, before or behind the fence.
InFlight::Meaning InFlight::error_for_value(const protocol::ErrorReply& error) {
    Meaning meaning;
    const auto waits = [&](const Item& item) {
        return !item.ended && !item.has_value && !item.value_error &&
               item.request.service() == error.service && item.wants_value() &&
               item.request.answer_tag == error.tag;
    };
    const auto take = [&](Item& item) {
        item.value_error.emplace(error.code, std::string(error.text));
        if (item.request.id != 0) meaning.owner = item.request.client;
        return meaning;
    };
    for (Awaiting& awaiting : awaiting_)
        if (waits(awaiting.item)) {
            awaiting.until = Time{};  // at once
            return take(awaiting.item);
        }
    for (Batch& batch : batches_)
        for (Item& item : batch.items)
            if (waits(item)) return take(item);
    meaning.unexplained = true;
    return meaning;
}

/// Which requests the unclear errors of a batch belong to, so that the digest is the one that the board sent.
/// The errors came in the order of their requests.
class InFlight::Explanation {
  public:
    Explanation(const Batch& batch, std::int64_t digest) : batch_(batch), digest_(digest) { try_from(0, {}); }

    /// Nothing that the board can have done has this digest.
    bool is_none() const { return found_ == 0; }
    /// The item of each unclear error; nothing where more than one explanation fits.
    const std::vector<std::size_t>* owners() const { return found_ == 1 ? &owners_ : nullptr; }

  private:
    void try_from(std::size_t next, protocol::Digest digest) {
        if (next == batch_.items.size()) return compare(digest);
        const Item& item = batch_.items[next];
        const auto with = [&](int error) {
            auto more = digest;
            more.add(item.request.line, error);
            try_from(next + 1, more);
        };
        // An error that comes instead of a value is none of the request as such.
        if (item.error) with(item.error->first);
        if (!item.error || item.wants_value()) with(0);
        if (item.error || tried_.size() == batch_.unclear.size()) return;
        const Unclear& error = batch_.unclear[tried_.size()];
        if (std::find(error.candidates.begin(), error.candidates.end(), next) == error.candidates.end())
            return;
        tried_.push_back(next);
        with(error.code);
        if (item.wants_value()) with(0);
        tried_.pop_back();
    }

    void compare(protocol::Digest digest) {
        if (tried_.size() != batch_.unclear.size()) return;
        digest.add(batch_.fence.line);
        if (digest.value() != digest_) return;
        if (found_++ == 0) owners_ = tried_;
    }

    const Batch& batch_;
    const std::int64_t digest_;
    std::vector<std::size_t> tried_;
    std::vector<std::size_t> owners_;
    unsigned found_ = 0;
};

bool InFlight::settle_errors(Batch& batch, const protocol::Event& event) {
    if (!batch.fence.verifies) return true;
    const auto digest = fence_digest(event);
    if (!digest) return false;
    const Explanation explanation(batch, *digest);
    if (explanation.is_none()) return false;
    const auto* const owners = explanation.owners();
    if (owners == nullptr) return true;
    for (Item& item : batch.items)
        item.suspected = false;
    for (std::size_t i = 0; i < owners->size(); ++i) {
        Unclear& error = batch.unclear[i];
        batch.items[(*owners)[i]].error.emplace(error.code, std::move(error.text));
    }
    return true;
}

}  // namespace asip::session
