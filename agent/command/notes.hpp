// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>
#include <utility>
#include <vector>

#include "asip/mqtt/message.hpp"

namespace asip::agent {

/// Notes of who commanded what, published a moment behind the answers: whoever waits for an answer shares the
/// broker, and often the processor, with them. At most kMax wait.
class Notes {
  public:
    static constexpr std::chrono::milliseconds kBehind{1};
    static constexpr std::size_t kMax = 64;
    using Publish = std::function<void(mqtt::Message)>;

    Notes(boost::asio::io_context& io, Publish publish) : timer_(io), publish_(std::move(publish)) {}

    void add(std::vector<mqtt::Message> notes) {
        if (notes.empty()) return;
        const bool idle = waiting_.empty();
        for (auto& note : notes)
            waiting_.push_back(std::move(note));
        if (waiting_.size() >= kMax) return publish_all();
        if (!idle) return;
        timer_.expires_after(kBehind);
        timer_.async_wait([this](boost::system::error_code error) {
            if (!error) publish_all();
        });
    }

    /// At once, as before a goodbye.
    void publish_all() {
        timer_.cancel();
        for (auto& note : std::exchange(waiting_, {}))
            publish_(std::move(note));
    }

  private:
    boost::asio::steady_timer timer_;
    Publish publish_;
    std::vector<mqtt::Message> waiting_;
};

}  // namespace asip::agent
