// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <deque>
#include <utility>

#include "agent/inbound/inbound.hpp"

namespace asip::agent {

/// Messages that came faster than they can be handled, in their order. The agent reads on while they wait, so
/// that it sees a stop behind them. Pure. Bounded by number and memory: where it is full(), the caller
/// handles the oldest before it reads on.
class Inbox {
  public:
    static constexpr std::size_t kMaxMessages = 12'288;
    /// Of memory, with everything that a message needs besides its payload.
    static constexpr std::size_t kMaxBytes = 16 << 20;

    bool empty() const { return entries_.empty(); }
    bool full() const { return entries_.size() >= kMaxMessages || bytes_ >= kMaxBytes; }
    std::size_t size() const { return entries_.size(); }
    /// Messages that no stop has caught yet.
    std::size_t waiting() const { return entries_.size() - stopped_; }

    /// Also where it is full already.
    void push(Inbound message) {
        const auto bytes = bytes_of(message);
        bytes_ += bytes;
        entries_.push_back({std::move(message), bytes});
    }
    /// Takes out the oldest message; a command that a stop has caught says so. Not when empty().
    Inbound pop() {
        Entry entry = std::move(entries_.front());
        entries_.pop_front();
        bytes_ -= entry.bytes;
        if (stopped_ > 0) {
            --stopped_;
            if (auto* command = std::get_if<Command>(&entry.message)) command->stopped = true;
        }
        return std::move(entry.message);
    }
    /// Everything that waits now came before a stop.
    void stop() { stopped_ = entries_.size(); }

  private:
    struct Entry {
        Inbound message;
        std::size_t bytes = 0;
    };
    std::deque<Entry> entries_;
    std::size_t bytes_ = 0;
    std::size_t stopped_ = 0;
};

}  // namespace asip::agent
