// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "agent/inbound/inbound.hpp"

namespace asip::agent {

/// Messages that wait to be handled, in order, while the agent reads on to see a stop behind them: at most
/// kAtOnce messages are handled in front of a stop. Bounded by number and memory: while it is full, each
/// message that arrives has the oldest handled. Pure.
class Inbox {
  public:
    static constexpr std::size_t kMaxMessages = 12'288;
    /// In memory, with all that a message needs besides its payload.
    static constexpr std::size_t kMaxBytes = 16 << 20;

    /// Handled in one turn of the program's loop.
    static constexpr std::size_t kAtOnce = 8;

    bool empty() const { return entries_.empty(); }
    bool full() const { return entries_.size() >= kMaxMessages || bytes_ >= kMaxBytes; }
    std::size_t size() const { return entries_.size(); }

    /// Returns what is to be handled now.
    std::optional<Inbound> arrive(Inbound message) {
        ++arrived_;
        if (empty() && arrived_ <= kAtOnce) return message;
        push(std::move(message));
        if (full()) return pop();
        return std::nullopt;
    }
    /// The caller has to ask its loop for a turn; true once for each.
    bool asks_for_turn() {
        if (asked_ || (arrived_ == 0 && empty())) return false;
        asked_ = true;
        return true;
    }
    /// How many of the oldest to handle in this turn: none while messages arrive, since a stop may be among
    /// them.
    std::size_t begin_turn() {
        asked_ = false;
        return std::exchange(arrived_, 0) > 0 ? 0 : std::min(kAtOnce, size());
    }

    /// Also where it is full.
    void push(Inbound message) {
        const auto bytes = bytes_of(message);
        bytes_ += bytes;
        entries_.push_back({std::move(message), bytes, false});
    }
    /// The oldest message; one that a stop has caught says so where that matters. Not when empty().
    Inbound pop() {
        Entry entry = std::move(entries_.front());
        entries_.pop_front();
        bytes_ -= entry.bytes;
        if (caught_ > 0) --caught_;
        std::visit(
            [&](auto& message) {
                if constexpr (requires { message.stopped; }) message.stopped = entry.stopped;
            },
            entry.message);
        return std::move(entry.message);
    }
    /// A stop catches what waits, except for what its sender sent behind it, as `sent_behind` says: the
    /// stop's own connection may be the slower one. Returns how many it caught.
    template <class SentBehind>
    std::size_t stop(SentBehind&& sent_behind) {
        std::size_t caught = 0;
        for (auto entry = entries_.begin() + static_cast<std::ptrdiff_t>(caught_); entry != entries_.end();
             ++entry) {
            if (entry->stopped || sent_behind(std::as_const(entry->message))) continue;
            entry->stopped = true;
            ++caught;
        }
        while (caught_ < entries_.size() && entries_[caught_].stopped)
            ++caught_;
        return caught;
    }

  private:
    struct Entry {
        Inbound message;
        std::size_t bytes = 0;
        bool stopped = false;  // a stop has caught it
    };
    std::deque<Entry> entries_;
    std::size_t bytes_ = 0;
    std::size_t caught_ = 0;   // how many of the oldest are stopped; a flood of stops does not look at them
                               // again
    std::size_t arrived_ = 0;  // since the last turn
    bool asked_ = false;       // for a turn
};

}  // namespace asip::agent
