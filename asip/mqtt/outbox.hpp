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

/// The messages that wait to be published: bounded, in order, urgent ones first.
/// A retained message replaces a waiting one of its topic, with the higher QoS of both: in its place if it
/// expires, since it is renewed again and again, else at the back. Beyond `max` the oldest context values are
/// dropped; replies and announcements are refused beyond twice `max`, urgent messages beyond three times.
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
        /// None: without an expiry, or retained, which describes a state and waits.
        std::optional<Time> until;
        Time since{};  ///< when it was published

        /// Also with less than a second left, the unit of MQTT, after it has waited.
        bool expired(Time now) const;
        /// The expiry becomes what is left, in whole seconds.
        void age(Time now);

      private:
        bool has_waited(Time now) const { return now - since >= std::chrono::seconds(1); }
    };

    explicit Outbox(Bounds max) : max_(max) {}

    /// False: refused.
    bool push(Message message, Priority priority, Time now = {});

    /// The entry that leaves next. Precondition: !empty().
    const Entry& front() const { return first()->front(); }

    /// Precondition: !empty().
    Entry pop();

    /// Returns an entry that was not delivered to its place, whatever the bounds, unless a newer retained
    /// message of its topic waits.
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
    /// Waiting retained messages, one for each topic.
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
