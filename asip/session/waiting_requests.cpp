#include "asip/session/waiting_requests.hpp"

#include <algorithm>
#include <utility>

namespace asip::session {

void WaitingRequests::push(Request request) {
    earliest_ = std::min(earliest_, request.deadline);
    auto& queue = queues_[request.client];
    if (queue.empty()) turns_.push_back(request.client);
    queue.push_back(std::move(request));
    ++size_;
}

std::size_t WaitingRequests::size_of(ClientId client) const {
    const auto queue = queues_.find(client);
    return queue == queues_.end() ? 0 : queue->second.size();
}

const Request& WaitingRequests::front() const {
    return own_.empty() ? queues_.find(turns_.front())->second.front() : own_.front();
}

Request WaitingRequests::pop() {
    if (!own_.empty()) {
        Request request = std::move(own_.front());
        own_.pop_front();
        return request;
    }
    const ClientId client = turns_.front();
    const auto queue = queues_.find(client);
    Request request = std::move(queue->second.front());
    queue->second.pop_front();
    turns_.pop_front();
    if (queue->second.empty()) {
        queues_.erase(queue);
    } else {
        turns_.push_back(client);
    }
    if (--size_ == 0) earliest_ = Time::max();
    return request;
}

std::vector<Request> WaitingRequests::take_expired(Time now) {
    std::vector<Request> expired;
    if (now < earliest_) return expired;
    earliest_ = Time::max();
    for (auto& [client, queue] : queues_) {
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
    }
    size_ -= expired.size();
    std::erase_if(queues_, [](const auto& entry) { return entry.second.empty(); });
    std::erase_if(turns_, [&](ClientId client) { return !queues_.contains(client); });
    return expired;
}

std::vector<Request> WaitingRequests::take_all() {
    std::vector<Request> all;
    for (auto& [client, queue] : queues_)
        for (Request& request : queue)
            all.push_back(std::move(request));
    *this = WaitingRequests{};
    return all;
}

}  // namespace asip::session
