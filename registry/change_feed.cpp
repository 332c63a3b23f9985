// SPDX-License-Identifier: Apache-2.0
#include "registry/change_feed.hpp"

namespace asip::registry {

void ChangeFeed::begin(std::string epoch) {
    epoch_ = std::move(epoch);
    state_ = State::kClosed;
}

bus::ChangeEvent ChangeFeed::event(bus::ChangeEvent::Kind kind, std::uint64_t seq, Instant now) const {
    bus::ChangeEvent result;
    result.kind = kind;
    result.registry = registry_;
    result.epoch = epoch_;
    result.seq = seq;
    result.at = now.wall;
    return result;
}

std::optional<bus::ChangeEvent> ChangeFeed::change(const Event& change, const Catalogue& catalogue,
                                                   Instant now, std::size_t queued) {
    if (state_ != State::kOpen) return std::nullopt;
    if (queued > kMaxQueued) {
        state_ = State::kOverrun;
        return std::nullopt;
    }
    auto result = event(static_cast<bus::ChangeEvent::Kind>(change.kind), change.seq, now);
    result.reason = to_text(change.reason);
    if (change.kind == Event::Kind::kState) result.was = model::to_text(change.was);
    if (auto item = catalogue.board(change.board, now)) result.board = std::move(*item);
    result.board.board = change.board;
    // The item is as it is now; with several changes at once each event carries its own state.
    result.board.state = model::to_text(change.state);
    for (auto& service : result.board.services)
        service.state = result.board.state;
    return result;
}

std::optional<bus::ChangeEvent> ChangeFeed::reset(const Catalogue& catalogue, Instant now,
                                                  std::size_t queued) {
    const bool due = state_ == State::kResetDue || state_ == State::kOverrun;
    if (!due || queued >= kMaxQueued / 10) return std::nullopt;
    state_ = State::kOpen;
    return event(bus::ChangeEvent::Kind::kReset, catalogue.seq(), now);
}

}  // namespace asip::registry
