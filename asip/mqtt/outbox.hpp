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

/// The messages that wait to be published: bounded, in order, and the least important dropped first.
///
/// Urgent messages leave first, all others in the order in which they came. A retained message replaces a
/// waiting one of the same topic, with the higher QoS of both: a message that expires takes the place of the
/// older one, since it is renewed again and again; any other goes to the back. When `max` is exceeded the
/// oldest context values are dropped. Replies and announcements are taken up to twice `max` and then refused,
/// urgent messages up to three times.
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
        /// When it expires. None without an expiry, and for retained messages: they describe a state, and
        /// wait for as long as it takes.
        std::optional<Time> until;
        Time since{};  ///< when it was published

        /// Also when less is left than a whole second, the unit of MQTT, after it has waited.
        bool expired(Time now) const;
        /// Sets the expiry of the message to what is left, in whole seconds.
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

    /// Returns an entry that was popped and not delivered to its old place, whatever the bounds. It is
    /// dropped if a newer retained message of its topic waits.
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
