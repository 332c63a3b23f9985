// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "agent/inbound/inbound.hpp"

namespace asip::agent {

/// Messages that came faster than they can be handled, in their order. The agent reads on while they wait, so
/// that it sees a stop behind them: of all that came before a stop, kAtOnce messages at most are handled in
/// front of it. Pure. Bounded by number and memory: while it is full, each message that arrives has the
/// oldest handled.
class Inbox {
  public:
    static constexpr std::size_t kMaxMessages = 12'288;
    /// Of memory, with everything that a message needs besides its payload.
    static constexpr std::size_t kMaxBytes = 16 << 20;

    /// So many messages are handled in one turn of the program's loop.
    static constexpr std::size_t kAtOnce = 8;

    bool empty() const { return entries_.empty(); }
    bool full() const { return entries_.size() >= kMaxMessages || bytes_ >= kMaxBytes; }
    std::size_t size() const { return entries_.size(); }

    /// A message arrives, and takes its turn. Returns what is to be handled now.
    std::optional<Inbound> arrive(Inbound message) {
        ++arrived_;
        if (empty() && arrived_ <= kAtOnce) return message;
        push(std::move(message));
        if (full()) return pop();
        return std::nullopt;
    }
    /// Whether the caller has to ask its loop for a turn. It asks once for each.
    bool asks_for_turn() {
        if (asked_ || (arrived_ == 0 && empty())) return false;
        asked_ = true;
        return true;
    }
    /// The turn has come. So many of the oldest are handled in it: none while messages arrive, for a stop may
    /// be among them.
    std::size_t begin_turn() {
        asked_ = false;
        return std::exchange(arrived_, 0) > 0 ? 0 : std::min(kAtOnce, size());
    }

    /// Also where it is full already.
    void push(Inbound message) {
        const auto bytes = bytes_of(message);
        bytes_ += bytes;
        entries_.push_back({std::move(message), bytes, false});
    }
    /// Takes out the oldest message; a command that a stop has caught says so. Not when empty().
    Inbound pop() {
        Entry entry = std::move(entries_.front());
        entries_.pop_front();
        bytes_ -= entry.bytes;
        if (caught_ > 0) --caught_;
        if (auto* command = std::get_if<Command>(&entry.message)) command->stopped = entry.stopped;
        return std::move(entry.message);
    }
    /// A stop came: it catches what waits, but for what its sender sent behind it. `sent_behind` says that of
    /// a message: stops come over a connection of their own, which may be the slower one. Returns how many it
    /// caught.
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
