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

/// Turns what a catalogue decides into the events that watchers receive: numbered without a gap, or a reset
/// that asks them to query again. Changes that come faster than the broker takes their events wait, those of
/// one board together as one: however large a burst, a watcher gets each board's state in the end, and no
/// reset. Numbers are given when an event is published. Pure.
class ChangeFeed {
  public:
    /// With this many messages waiting for the broker, changes wait here.
    static constexpr std::size_t kMaxQueued = 2000;
    /// Boards whose changes wait; of more, watchers get a reset, once nine tenths of the messages are sent.
    static constexpr std::size_t kMaxWaiting = 500'000;

    explicit ChangeFeed(std::string registry) : registry_(std::move(registry)) {}

    /// A new connection, under a new epoch: nothing is published until complete().
    void begin(std::string epoch);
    /// The connection is lost: changes until the next one are part of its reset.
    void end() { close(State::kClosed); }
    /// The catalogue is complete: a reset is due, then changes follow it.
    void complete() { close(State::kResetDue); }

    const std::string& epoch() const { return epoch_; }
    /// Number of the last event. What a query finds now holds all changes up to it, and those that wait.
    std::uint64_t seq() const { return seq_; }

    /// Takes a change. It is given out by next().
    void change(const Event& event);
    /// The next event to publish; nothing where none waits, or the broker is behind. `queued`: messages
    /// waiting for it.
    std::optional<bus::ChangeEvent> next(const Catalogue& catalogue, Instant now, std::size_t queued);
    /// The reset to publish, once one is due and the queue has drained.
    std::optional<bus::ChangeEvent> reset(Instant now, std::size_t queued);
    /// A reset is due because more boards change than may wait.
    bool overrun() const { return state_ == State::kOverrun; }
    /// Boards whose changes wait.
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

/// What is to be reported of one board after two changes, the second one later; nothing where a watcher needs
/// to know of neither.
std::optional<Event> together(const Event& first, const Event& second);

}  // namespace asip::registry
