// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "asip/bus/change_event.hpp"
#include "asip/bus/query.hpp"
#include "registry/catalogue/catalogue.hpp"

namespace asip::registry {

/// Turns what a catalogue decides into the events that watchers receive: numbered without a gap, or a reset
/// that asks them to query again. Pure.
class ChangeFeed {
  public:
    /// Beyond this many messages waiting for the broker, watchers get a reset instead of single changes; it
    /// is published once nine tenths of them are sent.
    static constexpr std::size_t kMaxQueued = 2000;

    explicit ChangeFeed(std::string registry) : registry_(std::move(registry)) {}

    /// A new connection, under a new epoch: nothing is published until complete().
    void begin(std::string epoch);
    /// The connection is lost: changes until the next one are part of its reset.
    void end() { state_ = State::kClosed; }
    /// The catalogue is complete: a reset is due, then changes follow it.
    void complete() { state_ = State::kResetDue; }

    const std::string& epoch() const { return epoch_; }

    /// The event to publish; nothing while closed or while a reset is due. `queued`: messages waiting.
    std::optional<bus::ChangeEvent> change(const Event& event, const Catalogue& catalogue, Instant now,
                                           std::size_t queued);
    /// The reset to publish, once one is due and the queue has drained.
    std::optional<bus::ChangeEvent> reset(const Catalogue& catalogue, Instant now, std::size_t queued);
    /// A reset is due because changes came faster than the broker accepts them.
    bool overrun() const { return state_ == State::kOverrun; }

  private:
    enum class State { kClosed, kResetDue, kOverrun, kOpen };

    bus::ChangeEvent event(bus::ChangeEvent::Kind kind, std::uint64_t seq, Instant now) const;

    std::string registry_;
    std::string epoch_;
    State state_ = State::kClosed;
};

}  // namespace asip::registry
