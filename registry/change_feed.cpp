// SPDX-License-Identifier: Apache-2.0
#include "registry/change_feed.hpp"

#include <utility>

namespace asip::registry {

std::optional<Event> together(const Event& first, const Event& second) {
    using enum Event::Kind;
    Event both = second;
    if (first.kind == kAdded) {
        if (second.kind == kForgotten) return std::nullopt;
        both.kind = kAdded;
        both.reason = first.reason;
    } else if (second.kind == kForgotten || second.kind == kAdded) {
        return both;
    } else if (first.kind == kState) {
        both.kind = kState;
        both.was = first.was;
        if (second.kind != kState) both.reason = first.reason;
    } else if (second.kind == kDescription) {
        both.kind = first.kind;
    }
    // What happened meanwhile may have changed more than the state.
    if (both.kind == kState && both.state == both.was) both.kind = kDescription;
    return both;
}

void ChangeFeed::begin(std::string epoch) {
    epoch_ = std::move(epoch);
    close(State::kClosed);
}

/// What waits is part of the reset.
void ChangeFeed::close(State state) {
    state_ = state;
    seq_ += waiting_.size();
    waiting_.clear();
    order_.clear();
}

bus::ChangeEvent ChangeFeed::event(bus::ChangeEvent::Kind kind, Instant now) const {
    bus::ChangeEvent result;
    result.kind = kind;
    result.registry = registry_;
    result.epoch = epoch_;
    result.seq = seq_;
    result.at = now.wall;
    return result;
}

void ChangeFeed::change(const Event& change) {
    if (state_ != State::kOpen) {
        ++seq_;
        return;
    }
    const auto [place, fresh] = waiting_.try_emplace(change.board, change);
    if (fresh) {
        order_.push_back(change.board);
        if (order_.size() > 2 * kMaxWaiting || waiting_.size() > kMaxWaiting) close(State::kOverrun);
    } else if (auto both = together(place->second, change)) {
        place->second = std::move(*both);
    } else {
        waiting_.erase(place);
    }
}

std::optional<bus::ChangeEvent> ChangeFeed::next(const Catalogue& catalogue, Instant now,
                                                 std::size_t queued) {
    if (state_ != State::kOpen || queued > kMaxQueued) return std::nullopt;
    while (!order_.empty()) {
        const auto found = waiting_.extract(order_.front());
        order_.pop_front();
        if (!found) continue;
        const Event& change = found.mapped();
        ++seq_;
        auto result = event(static_cast<bus::ChangeEvent::Kind>(change.kind), now);
        result.reason = model::to_text(change.reason);
        if (change.kind == Event::Kind::kState) result.was = model::to_text(change.was);
        if (auto item = catalogue.board(change.board, now)) result.board = std::move(*item);
        result.board.board = change.board;
        // The item is as it is now; with several changes at once each event carries its own state.
        result.board.state = model::to_text(change.state);
        for (auto& service : result.board.services)
            service.state = result.board.state;
        return result;
    }
    return std::nullopt;
}

std::optional<bus::ChangeEvent> ChangeFeed::reset(Instant now, std::size_t queued) {
    const bool due = state_ == State::kResetDue || state_ == State::kOverrun;
    if (!due || queued >= kMaxQueued / 10) return std::nullopt;
    state_ = State::kOpen;
    return event(bus::ChangeEvent::Kind::kReset, now);
}

}  // namespace asip::registry
