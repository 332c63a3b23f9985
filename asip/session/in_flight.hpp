// SPDX-License-Identifier: Apache-2.0
#pragma once
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

/// What was sent and has not ended: batches of requests, each closed by a fence, and requests that were
/// executed and wait for their value. Decides how each ends.
///
/// An error of the board names one request of a batch: they differ in service or tag. Requests of one client
/// need not differ where it wants no proof, or where the fence is a verified one: the digest tells
/// which of them had an error.
class InFlight {
  public:
    /// What a line from the board meant to us.
    struct Meaning {
        bool is_fence = false;          ///< the answer to a fence of ours, of now or of before
        std::optional<ClientId> owner;  ///< the answer to this client's question, or its error
        bool is_value = false;          ///< a request waits for such an event, or ended before it came
        /// An error that belongs to no request, or to one of the session's own that no digest speaks for.
        bool unexplained = false;
        bool contradicts = false;  ///< a fence: the board read something else than what was sent
    };

    bool empty() const { return batches_.empty(); }
    /// Bytes that may be in the board's receive buffer.
    std::size_t bytes() const { return bytes_; }
    bool has_open_batch() const { return !batches_.empty() && !batches_.back().fence.sent(); }
    bool open_batch_wants_proof() const;
    Time last_sent() const { return batches_.back().last_sent; }
    /// Whether the open batch may be closed now: not while the board may not have read a long request yet.
    bool may_close(Time now) const { return now >= batches_.back().close_after; }
    Time close_after() const { return batches_.back().close_after; }
    /// Whether a fence is out that is not overdue.
    bool fence_out() const;
    bool overdue() const { return !batches_.empty() && batches_.front().overdue; }
    std::size_t batches() const { return batches_.size(); }
    /// Nothing may follow before its fence is back.
    bool is_barrier() const;

    /// Whether `next` cannot join the open batch. `verified`: the digest that comes with its fence tells
    /// which of several requests an error belongs to.
    bool conflicts(const Request& next, bool verified) const;
    /// Whether some batch holds a request with this line, or was closed with it.
    bool holds_question(std::string_view line) const;

    /// Whether one that waits for the same kind of event is under way: one event may be the end of both, and
    /// come too early for the second.
    bool awaits_value_of(const Request& next) const;

    /// Whether a request is under way that sets the period of that service to 0.
    bool turns_reports_off(char service) const;
    /// Then the board has sent what others asked for that ended without it, as far as fences show until then
    /// that it does not stand still (see_again()): one behind that moment shows that it does not come any
    /// more. Time::min(): no other request did.
    Time owed_until(const Request& next, Time now) const;
    /// When the next fence is to be sent so that it shows that.
    Time see_again() const { return last_back_ + longest_gap() / 2; }
    /// The same where one is to be sent though no client waits; Time::max(): none is. A client that has
    /// little time would never wait for it.
    Time look_at() const;
    void looked();
    /// Whether the value of such a request was seen to take longer than its fence.
    bool comes_behind_fence(const Request& next) const;

    /// Whether the fence of some request is back and its value is not.
    bool awaits_values() const { return !awaiting_.empty(); }

    /// `bytes`: on the wire, with line end and checksum.
    /// True: only an event behind its fence can be its value.
    bool add(Request request, std::size_t bytes, bool reports, Time close_after, Time now);
    /// The one added last cannot be proven.
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

    /// Ends what has reached its deadline.
    void expire(Time now, std::vector<RequestEnd>& ended);
    /// Fences that are not back after `answer_timeout` are overdue: what they closed is no longer taken to be
    /// in the board's buffer. The number of those that became so now.
    unsigned mark_overdue(Time now, Duration answer_timeout);

    /// Ends everything: in doubt, or as timed out.
    void end_all(Ending ending, std::vector<RequestEnd>& ended);
    /// The board restarted: it sends nothing any more that a client asked for before.
    void forget_owed() { owed_.clear(); }

    /// Not after the moment when one of the above changes something.
    Time next_deadline(Duration answer_timeout) const;

  private:
    // Between two fences further apart the board may have stood still for too long to be sure that it has
    // sent what it was asked for: a good part of the least answer time of a service.
    static constexpr Duration kLongestGap = std::chrono::milliseconds(100);
    // Of fences that come back: two seconds.
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
    /// A request that ended without its value, which may still come.
    struct Owed {
        std::uint64_t number;
        char service;
        char tag;
        Time sent_by;         // the board has sent it then; Time::max(): no fence behind it is back
        std::uint64_t ended;  // as next_number_
        Duration answer_time;
        unsigned looks = kLooks;  // so many fences more are sent for it alone
    };
    /// An error that may belong to several requests of a batch.
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

    class Explanation;  // in_flight_digest.cpp
    // Gives each unclear error to the request that the digest says. False: the digest contradicts the batch.
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
    void note_slow(const Item& item, bool slow);
    bool settle_owed(const protocol::Event& event, std::uint64_t oldest_taker);
    bool is_late(const protocol::Event& event) const;
    Meaning error_for_value(const protocol::ErrorReply& error);
    void end_without_value(Item& item, Time sent_by, std::vector<RequestEnd>& ended);
    void remember_lost(const Fence& fence);

    std::deque<Batch> batches_;
    std::vector<Awaiting> awaiting_;
    std::deque<std::string> lost_tokens_;  // whose answers may still come
    std::vector<Owed> owed_;
    std::vector<std::pair<char, char>> slow_;  // service and tag of values that come behind the fence
    std::uint64_t next_number_ = 1;
    std::size_t bytes_ = 0;
    bool stood_still_ = false;     // the board may have: a fence is overdue
    Time last_back_{};             // when a fence last came back
    Duration usual_way_{};         // of a fence, there and back
    Time earliest_ = Time::max();  // not after the first deadline of an item
};

}  // namespace asip::session
