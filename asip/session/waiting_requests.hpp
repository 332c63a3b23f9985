// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <deque>
#include <unordered_map>
#include <vector>

#include "asip/session/request.hpp"

namespace asip::session {

/// Requests that were not sent yet: a queue for each client, served in turn, before all of them the session's
/// own requests, and before those the urgent ones. Of one client each request comes after the one before.
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

    /// Passes over clients whose next request is not to be sent now; they keep their place. False: all of
    /// them.
    template <class MayGo>
    bool turn_to(MayGo&& may_go) {
        if (!urgent_.empty() || !own_.empty()) return true;
        const auto turn = std::find_if(turns_.begin(), turns_.end(), [&](ClientId client) {
            return may_go(queues_.find(client)->second.front());
        });
        if (turn == turns_.end()) return false;
        std::rotate(turns_.begin(), turn, turn + 1);
        return true;
    }
    /// The request whose turn it is. Not when empty().
    const Request& front() const;
    Request pop();

    /// Not after the earliest deadline of what waits; Time::max() where nothing has one.
    Time earliest_deadline() const { return earliest_; }
    /// Takes out what has reached its deadline.
    std::vector<Request> take_expired(Time now);
    /// Takes out all requests of clients, and forgets the session's own.
    std::vector<Request> take_all();
    /// Takes out what clients wait for, but for what is urgent.
    std::vector<Request> take_queued();
    void forget_own() { own_.clear(); }

  private:
    std::deque<Request> urgent_;
    std::deque<Request> own_;
    std::unordered_map<ClientId, std::deque<Request>> queues_;  // none of them empty
    std::deque<ClientId> turns_;                                // each client of queues_ once
    std::size_t size_ = 0;                                      // of queues_
    Time earliest_ = Time::max();
};

}  // namespace asip::session
