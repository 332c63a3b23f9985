// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <deque>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "asip/protocol/limits.hpp"
#include "asip/session/fences.hpp"
#include "asip/session/in_flight.hpp"
#include "asip/session/request.hpp"

namespace asip::session {

/// Requests that were not sent yet: urgent ones, then the session's own, then those of clients in turn.
/// Requests of one client keep their order.
class WaitingRequests {
  public:
    void push(Request request);
    void push_own(Request request) { own_.push_back(std::move(request)); }

    bool empty() const { return urgent_.empty() && own_.empty() && turns_.empty(); }
    std::size_t size() const { return size_ + own_.size() + urgent_.size(); }
    std::size_t urgent() const { return urgent_.size(); }
    /// One of the session's own turns checksums on or off.
    bool changes_line() const;
    std::size_t size_of(ClientId client) const;

    /// Passes over clients whose next request may not go now, or would come between requests of another that
    /// belong together; they keep their place. False: none may.
    template <class MayGo>
    bool turn_to(MayGo&& may_go) {
        if (!urgent_.empty() || !own_.empty()) return true;
        const auto may = [&](ClientId client) {
            const Request& next = queues_.find(client)->second.front();
            return !waits_for_others(next) && may_go(next);
        };
        // What belongs together has each second turn: a board does not wait long for the rest.
        auto turn = turns_.end();
        if (!row_went_ && !rows_.empty())
            turn = std::find_if(turns_.begin(), turns_.end(),
                                [&](ClientId client) { return in_row(client) && may(client); });
        if (turn == turns_.end()) turn = std::find_if(turns_.begin(), turns_.end(), may);
        if (turn == turns_.end()) return false;
        std::rotate(turns_.begin(), turn, turn + 1);
        return true;
    }
    /// Not when empty().
    const Request& front() const;
    Request pop();

    /// Not later than the earliest deadline; Time::max(): there is none.
    Time earliest_deadline() const;
    std::vector<Request> take_expired(Time now);
    /// Takes out all requests of clients, and forgets the session's own.
    std::vector<Request> take_all();
    /// Takes out what clients wait for and is not urgent.
    std::vector<Request> take_queued();
    void forget_own() { own_.clear(); }
    /// Returns their number.
    template <class Which>
    std::size_t forget_own(Which&& which) {
        return std::erase_if(own_, which);
    }

  private:
    /// Requests for one service that belong together, of which more follow.
    struct Row {
        ClientId client;
        Time until;
    };
    bool waits_for_others(const Request& next) const {
        const auto row = rows_.find(next.service());
        return row != rows_.end() && row->second.client != next.client;
    }
    bool in_row(ClientId client) const {
        return std::any_of(rows_.begin(), rows_.end(),
                           [&](const auto& row) { return row.second.client == client; });
    }

    std::deque<Request> urgent_;
    std::deque<Request> own_;
    std::unordered_map<ClientId, std::deque<Request>> queues_;  // none of them empty
    std::deque<ClientId> turns_;                                // each client of queues_ once
    std::size_t size_ = 0;                                      // of queues_
    std::map<char, Row> rows_;                                  // by service
    bool row_went_ = false;                                     // in the last turn
    Time earliest_ = Time::max();
};

/// Paces requests and proves them: requests and fences together never exceed the board's receive buffer.
/// While a fence is overdue nothing but fences is sent. Fences of a 0.4 board have no tokens: one is out at a
/// time.
class RequestQueue {
  public:
    /// An Arduino's: 64 bytes less one.
    static constexpr std::size_t kReceiveBufferBytes = 63;
    /// How much of it is used while the board reports by itself.
    static constexpr std::size_t kWhileReporting = 48;

    explicit RequestQueue(const Random& random) : fences_(random) {}

    // --- what is known of the board and the line
    /// `verified`: the board digests what it reads.
    void use_echo(bool verified) { fences_.use_echo(verified); }
    void use_questions(std::string second) { fences_.use_questions(std::move(second)); }
    /// That a line gets on the wire.
    void set_checksum_bytes(std::size_t bytes) { checksum_bytes_ = bytes; }
    /// Zero: the line has no rate.
    void set_byte_time(Duration time) { byte_time_ = time; }
    /// The board read what is not in flight here.
    void forget_digest() {
        digest_known_ = false;
        if (fences_.verified()) doubt();
    }
    /// Without line end and checksum.
    void set_longest_request(std::size_t bytes) { longest_request_ = bytes; }
    /// While on, what is not urgent waits.
    void hold_back(bool on) { held_back_ = on; }
    /// The board sends events by itself.
    void set_reporting(bool on) { reporting_ = on; }

    WaitingRequests& waiting() { return waiting_; }
    const WaitingRequests& waiting() const { return waiting_; }

    /// The next request of a client, with so many bytes behind it, exceeds the board's line buffer.
    bool next_is_too_long_for(std::size_t checksum_bytes) const;
    bool switching_line() const;

    /// Lines to write now, without line end and checksum. `reports(request)`: the SelfReports of its value.
    template <class Reports>
    std::vector<std::string> pump(Time now, Reports&& reports) {
        std::vector<std::string> lines;
        look_for_owed(now);
        send_probe(now, lines);
        settled_at_ = Time::max();
        fills_batch_ = false;
        const auto may_go = [&](const Request& one) {
            return !in_flight_.awaits_value_of(one) && !settles_first(one, reports(one), now);
        };
        while (!waiting_.empty() && waiting_.turn_to(may_go) && next_may_go(now, lines)) {
            Request next = waiting_.pop();
            const SelfReports self = reports(next);
            next.answer_time += self.every;
            send(std::move(next), self.until > now, now, lines);
        }
        send_probe(now, lines);
        send_last_fence(now, lines);
        const Time look = in_flight_.look_at();
        if (!in_flight_.fence_out() && look > now) settled_at_ = std::min(settled_at_, look);
        return lines;
    }

    InFlight::Meaning on_event(const protocol::Event& event, const protocol::ParsedLine& line, Time now,
                               std::vector<RequestEnd>& ended);
    InFlight::Meaning on_error(const protocol::ErrorReply& error);
    bool refutes(const protocol::Event& event) const { return in_flight_.refutes(event); }
    void doubt() { in_flight_.doubt(); }
    /// Ends what has reached its deadline, notices overdue fences.
    void on_time(Time now, Duration answer_timeout, std::vector<RequestEnd>& ended);

    /// Link or board went, or the board restarted. What waits stays.
    void abandon_in_flight(Ending ending, std::vector<RequestEnd>& ended);
    void abandon_waiting(std::vector<RequestEnd>& ended);
    void cancel_waiting(std::vector<RequestEnd>& ended);
    /// What the board owed does not come any more.
    void board_restarted() { in_flight_.forget_owed(); }
    /// The board was found again: no earlier fence is missing.
    void restart();

    /// Sends a fence alone, to see whether the board lives, unless one is out.
    void probe();

    Time next_deadline(Duration answer_timeout) const;
    std::size_t bytes_in_flight() const { return in_flight_.bytes(); }
    bool in_flight() const { return !in_flight_.empty(); }
    bool idle() const { return waiting_.empty() && in_flight_.empty(); }
    /// Nothing but fences is sent.
    bool stalled() const { return stalled_; }
    /// The next lines begin with a fence that shows whether the board executes requests.
    bool will_resynchronise() const { return stalled_ && !in_flight_.fence_out(); }
    /// The next line does not wait for such a fence, and little is on its way.
    bool urgent_while_stalled() const;
    /// In a row.
    unsigned lost_fences() const { return lost_fences_; }
    std::uint64_t fence_timeouts() const { return fence_timeouts_; }

  private:
    void look_for_owed(Time now);
    void send_probe(Time now, std::vector<std::string>& lines);
    bool settles_first(const Request& next, const SelfReports& reports, Time now);
    bool next_may_go(Time now, std::vector<std::string>& lines);
    bool may_fill_batch(Time now) const;
    void send(Request request, bool reports, Time now, std::vector<std::string>& lines);
    void send_last_fence(Time now, std::vector<std::string>& lines);
    bool may_fence(Time now) const;
    void close(Time now, std::vector<std::string>& lines);
    std::size_t wire_bytes(const Request& request) const { return request.line.size() + 1 + checksum_bytes_; }
    std::size_t fence_bytes() const;
    // A board with verified fences reads into its buffer whatever else it does.
    std::size_t room() const {
        return reporting_ && !fences_.verified() ? kWhileReporting : kReceiveBufferBytes;
    }

    WaitingRequests waiting_;
    InFlight in_flight_;
    Fences fences_;
    bool digest_known_ = false;  // the board's digest begins behind the last fence
    std::size_t checksum_bytes_ = 0;
    std::size_t longest_request_ = protocol::kUsualRequestBytes;
    Duration byte_time_{};
    bool reporting_ = false;
    bool stalled_ = false;  // a fence is overdue
    bool held_back_ = false;
    bool probe_wanted_ = false;
    bool fills_batch_ = false;       // the open batch gets its fence when there is room for more of them
    Time settled_at_ = Time::max();  // when what waits for the last reports may go
    unsigned lost_fences_ = 0;
    std::uint64_t fence_timeouts_ = 0;
};

}  // namespace asip::session
