// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/outbox.hpp"

#include <algorithm>

namespace asip::mqtt {
namespace {

/// So many times as full as the queue may be.
std::size_t bound_of(Priority priority) {
    switch (priority) {
        case Priority::kContext:
            return 1;
        case Priority::kUrgent:
            return 3;
        case Priority::kReply:
        case Priority::kAnnouncement:
            break;
    }
    return 2;
}

}  // namespace

void Outbox::insert(Queue& queue, Queue::iterator before, Entry entry) {
    ++size_;
    bytes_ += entry.message.bytes();
    const auto place = queue.insert(before, std::move(entry));
    if (place->message.retain) retained_[place->message.topic] = {&queue, place};
}

Outbox::Entry Outbox::take(Queue& queue, Queue::iterator entry) {
    --size_;
    bytes_ -= entry->message.bytes();
    if (entry->message.retain) retained_.erase(entry->message.topic);
    auto taken = std::move(*entry);
    queue.erase(entry);
    return taken;
}

void Outbox::erase(Queue& queue, Queue::iterator entry) {
    take(queue, entry);
}

/// At the back, what is renewed faster than the queue empties would never leave.
bool Outbox::replaced(Entry& older, Message& message, Priority priority) {
    const auto bytes = bytes_ - older.message.bytes() + message.bytes();
    const bool renewed = message.expiry_seconds && older.message.expiry_seconds;
    if (!renewed || older.priority != priority || bytes > max_.bytes) return false;
    bytes_ = bytes;
    older.message = std::move(message);
    return true;
}

bool Outbox::Entry::expired(Time now) const {
    return until && *until - now < (has_waited(now) ? std::chrono::seconds(1) : Duration(1));
}

void Outbox::Entry::age(Time now) {
    if (!until) return;
    const Duration left = *until - now;
    message.expire_after(has_waited(now) ? std::chrono::floor<std::chrono::seconds>(left) : left);
}

bool Outbox::push(Message message, Priority priority, Time now) {
    if (message.retain) {
        if (const auto older = retained_.find(message.topic); older != retained_.end()) {
            const auto place = older->second;
            message.qos = std::max(message.qos, place.entry->message.qos);
            if (replaced(*place.entry, message, priority)) return true;
            erase(*place.queue, place.entry);
        }
    }
    const auto added = message.bytes();
    auto& context = queue(Priority::kContext);
    const auto fits = [&](std::size_t times) {
        return size_ + 1 <= max_.messages * times && bytes_ + added <= max_.bytes * times;
    };
    while (!fits(1) && !context.empty()) {
        erase(context, context.begin());
        ++dropped_;
    }
    if (!fits(bound_of(priority))) return false;
    auto& own = queue(priority);
    std::optional<Time> until;
    if (message.expiry_seconds && !message.retain)
        until = now + std::chrono::seconds(*message.expiry_seconds);
    insert(own, own.end(), Entry{std::move(message), priority, next_order_++, until, now});
    return true;
}

const Outbox::Queue* Outbox::first() const {
    if (const auto& urgent = queue(Priority::kUrgent); !urgent.empty()) return &urgent;
    const Queue* found = nullptr;
    for (const auto& queue : queues_) {
        if (queue.empty()) continue;
        if (found == nullptr || queue.front().order < found->front().order) found = &queue;
    }
    return found;
}

Outbox::Entry Outbox::pop() {
    auto& from = queue(first()->front().priority);
    return take(from, from.begin());
}

void Outbox::put_back(Entry entry) {
    if (const auto other = entry.message.retain ? retained_.find(entry.message.topic) : retained_.end();
        other != retained_.end()) {
        const auto place = other->second;
        auto& waiting = place.entry->message;
        if (place.entry->order > entry.order) {
            waiting.qos = std::max(waiting.qos, entry.message.qos);
            return;
        }
        erase(*place.queue, place.entry);
    }
    auto& own = queue(entry.priority);
    const auto later =
        std::find_if(own.begin(), own.end(), [&](const Entry& e) { return e.order > entry.order; });
    insert(own, later, std::move(entry));
}

void Outbox::discard(Priority priority) {
    auto& own = queue(priority);
    while (!own.empty())
        erase(own, own.begin());
}

}  // namespace asip::mqtt
