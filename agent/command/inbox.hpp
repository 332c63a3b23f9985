// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <utility>

#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Commands that came faster than they can be handled. Reading on while they wait is what lets a stop behind
/// them be seen. Pure and bounded: where it is full, the oldest is to be handled first.
class Inbox {
  public:
    static constexpr std::size_t kMaxMessages = 12'288;
    static constexpr std::size_t kMaxBytes = 8 << 20;

    struct Entry {
        mqtt::Message message;
        Time arrived{};
        bool stopped = false;  ///< a stop arrived behind it
    };

    bool empty() const { return entries_.empty(); }
    bool full() const { return entries_.size() >= kMaxMessages || bytes_ >= kMaxBytes; }
    std::size_t size() const { return entries_.size(); }
    /// Of them, those that no stop has caught yet.
    std::size_t waiting() const { return entries_.size() - stopped_; }

    void push(const mqtt::Message& message, Time now) {
        bytes_ += weight(message);
        entries_.push_back({message, now, false});
    }
    /// Not when empty().
    Entry pop() {
        Entry entry = std::move(entries_.front());
        entries_.pop_front();
        bytes_ -= weight(entry.message);
        entry.stopped = stopped_ > 0;
        if (stopped_ > 0) --stopped_;
        return entry;
    }
    /// Everything that waits now came before a stop.
    void stop() { stopped_ = entries_.size(); }

  private:
    static std::size_t weight(const mqtt::Message& message) { return sizeof(Entry) + message.bytes(); }

    std::deque<Entry> entries_;
    std::size_t bytes_ = 0;
    std::size_t stopped_ = 0;
};

}  // namespace asip::agent
