#pragma once
#include <cstddef>
#include <deque>
#include <unordered_map>
#include <vector>

#include "asip/session/request.hpp"

namespace asip::session {

/// Requests that were not sent yet: a queue for each client, served in turn, and before all of them the
/// session's own requests. Of one client each request comes after the one before.
class WaitingRequests {
  public:
    void push(Request request);
    void push_own(Request request) { own_.push_back(std::move(request)); }

    bool empty() const { return own_.empty() && turns_.empty(); }
    std::size_t size() const { return size_ + own_.size(); }
    std::size_t size_of(ClientId client) const;

    /// The request whose turn it is. Not when empty().
    const Request& front() const;
    Request pop();

    /// Not after the earliest deadline of what waits; Time::max() where nothing has one.
    Time earliest_deadline() const { return earliest_; }
    /// Takes out what has reached its deadline.
    std::vector<Request> take_expired(Time now);
    /// Takes out all requests of clients, and forgets the session's own.
    std::vector<Request> take_all();
    void forget_own() { own_.clear(); }

  private:
    std::deque<Request> own_;
    std::unordered_map<ClientId, std::deque<Request>> queues_;  // none of them empty
    std::deque<ClientId> turns_;                                // each client of queues_ once
    std::size_t size_ = 0;
    Time earliest_ = Time::max();
};

}  // namespace asip::session
