// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <unordered_map>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/query.hpp"
#include "registry/catalogue_types.hpp"

namespace asip::registry {

/// Turns decisions of a catalogue into events for watchers: numbered without a gap, or a reset that asks them
/// to query again. Changes that are faster than the broker wait, those of one board as one: after any burst a
/// watcher has each board's state. An event is numbered when it is published. Pure.
class ChangeFeed {
  public:
    /// With so many messages waiting for the broker, changes wait here.
    static constexpr std::size_t kMaxQueued = 2000;
    /// Boards whose changes may wait; beyond, watchers get a reset once nine tenths of the messages are sent.
    static constexpr std::size_t kMaxWaiting = 500'000;

    explicit ChangeFeed(std::string registry) : registry_(std::move(registry)) {}

    /// A new connection with a new epoch: nothing is published until complete().
    void begin(std::string epoch);
    /// Changes until the next connection are part of its reset.
    void end() { close(State::kClosed); }
    /// A reset is due, then changes follow it.
    void complete() { close(State::kResetDue); }

    const std::string& epoch() const { return epoch_; }
    /// Number of the last event. A query now finds all changes up to it, and those that wait.
    std::uint64_t seq() const { return seq_; }

    void change(const Event& event);
    /// Nothing: no event waits, or the broker is behind. `queued`: messages that wait for it.
    std::optional<bus::ChangeEvent> next(const Catalogue& catalogue, Instant now, std::size_t queued);
    /// Nothing: no reset is due, or the queue has not drained.
    std::optional<bus::ChangeEvent> reset(Instant now, std::size_t queued);
    /// A reset is due because too many boards change.
    bool overrun() const { return state_ == State::kOverrun; }
    std::size_t waiting() const { return waiting_.size(); }

  private:
    enum class State { kClosed, kResetDue, kOverrun, kOpen };

    void close(State state);
    bus::ChangeEvent event(bus::ChangeEvent::Kind kind, Instant now) const;

    std::string registry_;
    std::string epoch_;
    State state_ = State::kClosed;
    std::uint64_t seq_ = 0;
    std::unordered_map<std::string, Event> waiting_;
    std::deque<std::string> order_;  // of waiting_; of a name that is not there, nothing is to be said
};

/// The sum of two changes of one board, `second` being later; nothing: a watcher needs neither.
std::optional<Event> together(const Event& first, const Event& second);

}  // namespace asip::registry
