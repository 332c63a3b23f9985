// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asip/protocol/checksum.hpp"
#include "asip/protocol/message.hpp"
#include "asip/session/fences.hpp"
#include "asip/session/request.hpp"

namespace asip::session {

/// What was sent and has not ended: batches of requests, each closed by a fence, and executed requests that
/// wait for their value. Decides how each ends.
/// An error names one request of a batch by service and tag. Two of one client may share both where no proof
/// is wanted, or where the digest of a verified fence tells which had the error.
class InFlight {
  public:
    struct Meaning {
        bool is_fence = false;          ///< the answer to a fence of ours, of now or of before
        std::optional<ClientId> owner;  ///< the answer to this client's question, or its error
        bool is_value = false;          ///< a request waits for such an event, or ended before it came
        /// An error of no request, or of one of the session's own without a digest.
        bool unexplained = false;
        bool contradicts = false;  ///< a fence: the board read something else than what was sent
    };

    bool empty() const { return batches_.empty(); }
    /// In the board's receive buffer, at most.
    std::size_t bytes() const { return bytes_; }
    bool has_open_batch() const { return !batches_.empty() && !batches_.back().fence.sent(); }
    bool open_batch_wants_proof() const;
    Time last_sent() const { return batches_.back().last_sent; }
    /// False: the board may not have read a long request yet.
    bool may_close(Time now) const { return now >= batches_.back().close_after; }
    Time close_after() const { return batches_.back().close_after; }
    /// A fence is out and not overdue.
    bool fence_out() const;
    bool overdue() const { return !batches_.empty() && batches_.front().overdue; }
    std::size_t batches() const { return batches_.size(); }
    /// Nothing may follow before its fence is back.
    bool is_barrier() const;

    /// `next` cannot join the open batch. `verified`: a digest tells which request an error belongs to.
    bool conflicts(const Request& next, bool verified) const;
    /// Some batch holds a request with this line, or was closed with it.
    bool holds_question(std::string_view line) const;

    /// A request that waits for the same kind of event is under way. One event might end both, and come too
    /// early for the second.
    bool awaits_value_of(const Request& next) const;

    /// A request under way sets the period of that service to 0.
    bool turns_reports_off(char service) const;
    /// By this time the board has sent the values that earlier requests gave up waiting for. A fence answered
    /// later proves that none is left. Time::min(): there were no such requests.
    Time owed_until(const Request& next, Time now) const;
    /// When the next fence is due for that proof.
    Time see_again() const { return last_back_ + longest_gap() / 2; }
    /// When a fence is due for that proof though no client waits, since one in a hurry never would;
    /// Time::max(): none is.
    Time look_at() const;
    void looked();

    /// The fence of some request is back and its value is not.
    bool awaits_values() const { return !awaiting_.empty(); }

    /// `bytes`: on the wire, with line end and checksum. True: only an event behind its fence can be its
    /// value.
    bool add(Request request, std::size_t bytes, bool reports, Time close_after, Time now);
    void doubt_last() { batches_.back().items.back().doubted = true; }
    /// Closes the open batch, or sends a fence with nothing before it.
    void close(Fence fence, std::size_t bytes, Time now);

    Meaning on_event(const protocol::Event& event, const protocol::ParsedLine& line, Time now,
                     std::vector<RequestEnd>& ended);
    /// `checksums`: the requests in flight have one.
    Meaning on_error(const protocol::ErrorReply& error, bool checksums);
    /// Whether a request waits for an event of that service and tag, and this one cannot be its answer.
    bool refutes(const protocol::Event& event) const;
    /// Something was lost or damaged, or the board restarted: nothing that is in flight can be proven now.
    void doubt();

    void expire(Time now, std::vector<RequestEnd>& ended);
    /// Makes fences overdue that are not back after `answer_timeout`: what they closed no longer counts as in
    /// the board's buffer. Returns how many are overdue since now.
    unsigned mark_overdue(Time now, Duration answer_timeout);

    void end_all(Ending ending, std::vector<RequestEnd>& ended);
    /// After its restart the board owes no value.
    void forget_owed() { owed_.clear(); }

    /// Not later than the next of these events.
    Time next_deadline(Duration answer_timeout) const;

  private:
    // After a longer gap between two fences the board may have stood still, and not have sent what it was
    // asked for.
    static constexpr Duration kLongestGap = std::chrono::milliseconds(100);
    // Fences that come back, for a value that is owed: two seconds.
    static constexpr unsigned kLooks = 40;

    struct Item {
        Request request;
        bool ended = false;
        bool asked = false;  // a question whose answer has not come
        bool doubted = false;
        std::uint64_t number = 0;   // in the order of sending
        bool follows_owed = false;  // an event of that tag may come that a request before it asked for
        // Or one of reports. Only those behind its fence count
        bool behind_fence = false;
        bool has_value = false;
        protocol::ParsedLine answer;
        std::optional<std::pair<int, std::string>> error;
        std::optional<std::pair<int, std::string>> value_error;  // came in place of the value
        bool suspected = false;                                  // one of the unclear errors may be its own
        bool wants_value() const { return request.answer_tag != 0; }
    };
    struct Owed {
        std::uint64_t number;
        char service;
        char tag;
        Time sent_by;         // the board has sent it then; Time::max(): no fence behind it is back
        std::uint64_t ended;  // as next_number_
        Duration answer_time;
        unsigned looks = kLooks;  // so many fences more are sent for it alone
    };
    struct Unclear {
        int code;
        std::string text;
        std::vector<std::size_t> candidates;  // indices of items
    };
    struct Batch {
        std::vector<Item> items;
        std::vector<Unclear> unclear;  // as they came
        Fence fence;
        std::size_t bytes = 0;
        std::uint64_t number = 0;  // of its fence, in the order of sending
        Time last_sent{};
        Time close_after{};
        bool overdue = false;
    };
    struct Awaiting {
        Item item;
        Time until;
        Time latest;  // the board has sent its value then
    };

    template <class Is>
    bool any_sent(const Is& is) const {
        return std::any_of(batches_.begin(), batches_.end(), [&](const Batch& batch) {
            return std::any_of(batch.items.begin(), batch.items.end(), is);
        });
    }
    template <class Is>
    bool any_awaiting(const Is& is) const {
        return std::any_of(awaiting_.begin(), awaiting_.end(),
                           [&](const Awaiting& one) { return is(one.item); });
    }
    class Explanation;
    // By the digest. False: the digest contradicts the batch.
    static bool settle_errors(Batch& batch, const protocol::Event& event);
    Item* find_question(const protocol::Event& event);
    void goes_on(Time now);
    void see_running(const Batch& batch, Time now);
    Duration longest_gap() const { return kLongestGap + 2 * usual_way_; }
    void fences_back(std::size_t batch, bool ambiguous, Time now, std::vector<RequestEnd>& ended);
    void finish(Batch batch, bool missing, Time now, std::vector<RequestEnd>& ended);
    void end(Item& item, Ending ending, std::vector<RequestEnd>& ended, Time sent_by = Time::max());
    bool note_value(const protocol::Event& event, const protocol::ParsedLine& line,
                    std::vector<RequestEnd>& ended);
    void forget_owed(const Batch& batch, Time now);
    void note_owed(const Item& item, Ending ending, Time sent_by);
    bool changes_period(char service) const;
    bool settle_owed(const protocol::Event& event, std::uint64_t oldest_taker);
    bool is_late(const protocol::Event& event) const;
    Meaning error_for_value(const protocol::ErrorReply& error);
    void end_without_value(Item& item, Time sent_by, std::vector<RequestEnd>& ended);
    void remember_lost(const Fence& fence);

    std::deque<Batch> batches_;
    std::vector<Awaiting> awaiting_;
    std::deque<std::string> lost_tokens_;  // whose answers may still come
    std::vector<Owed> owed_;
    std::uint64_t next_number_ = 1;
    std::size_t bytes_ = 0;
    bool stood_still_ = false;     // the board may have: a fence is overdue
    Time last_back_{};             // when a fence last came back
    Duration usual_way_{};         // of a fence, there and back
    Time earliest_ = Time::max();  // not after the first deadline of an item
};

}  // namespace asip::session
