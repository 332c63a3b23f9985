// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <string>
#include <unordered_map>

#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"

namespace asip::mqtt {

/// What waits to be published: bounded, in order, dropping what matters least.
///
/// Urgent entries leave first, all others in the order they came, whatever their priority. A retained message
/// replaces a waiting one of the same topic: one that expires, and so is renewed again and again, in its
/// place, any other at the back; with the higher QoS of both, since somebody waits for that. When `max` is
/// exceeded the oldest context values are dropped; what may not be dropped is taken up to twice `max` and
/// then refused, what is urgent up to three times.
class Outbox {
  public:
    struct Bounds {
        std::size_t messages;
        std::size_t bytes;  ///< of topics and payloads
    };
    struct Entry {
        Message message;
        Priority priority;
        std::uint64_t order;  ///< for put_back()
        /// Its time is over then: whoever published it wants it no more. None without an expiry, and of what
        /// is retained: that says how things are, and waits for as long as it takes.
        std::optional<Time> until;
        Time since{};  ///< when it was published

        /// Or too little is left to say so in whole seconds.
        bool expired(Time now) const;
        /// Makes its expiry what is left of it, in whole seconds: not more than there is, once it has waited
        /// for one.
        void age(Time now);

      private:
        bool has_waited(Time now) const { return now - since >= std::chrono::seconds(1); }
    };

    explicit Outbox(Bounds max) : max_(max) {}

    /// False: refused.
    bool push(Message message, Priority priority, Time now = {});

    /// The entry that leaves next. Precondition: !empty().
    const Entry& front() const { return first()->front(); }

    /// The same, taken out. Precondition: !empty().
    Entry pop();

    /// Returns an entry that was popped but not delivered to its old place; a newer retained message of its
    /// topic makes it obsolete, and bounds do not apply: it had been let in.
    void put_back(Entry entry);

    void discard(Priority priority);

    bool empty() const { return size_ == 0; }
    std::size_t size() const { return size_; }
    std::size_t bytes() const { return bytes_; }
    std::uint64_t dropped() const { return dropped_; }

  private:
    using Queue = std::list<Entry>;
    static constexpr int kPriorities = 4;

    const Queue* first() const;
    Queue& queue(Priority priority) { return queues_[static_cast<int>(priority)]; }
    const Queue& queue(Priority priority) const { return queues_[static_cast<int>(priority)]; }
    bool replaced(Entry& older, Message& message, Priority priority);
    Entry take(Queue& queue, Queue::iterator entry);
    void erase(Queue& queue, Queue::iterator entry);
    void insert(Queue& queue, Queue::iterator before, Entry entry);

    Bounds max_;
    Queue queues_[kPriorities];
    /// Waiting retained messages by topic; the newest of a topic is the only one.
    struct Place {
        Queue* queue;
        Queue::iterator entry;
    };
    std::unordered_map<std::string, Place> retained_;
    std::size_t size_ = 0;
    std::size_t bytes_ = 0;
    std::uint64_t next_order_ = 0;
    std::uint64_t dropped_ = 0;
};

}  // namespace asip::mqtt
