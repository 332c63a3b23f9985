// SPDX-License-Identifier: Apache-2.0
#include "asip/session/waiting_requests.hpp"

#include <algorithm>
#include <utility>

namespace asip::session {

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
    turns_.pop_front();
    if (queue->second.empty()) {
        queues_.erase(queue);
    } else {
        turns_.push_back(client);
    }
    if (--size_ == 0 && urgent_.empty()) earliest_ = Time::max();
    return request;
}

std::vector<Request> WaitingRequests::take_expired(Time now) {
    std::vector<Request> expired;
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

}  // namespace asip::session
