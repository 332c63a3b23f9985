// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <cstdint>
#include <deque>
#include <memory>
#include <utility>

#include "asip/client/awaitable.hpp"
#include "asip/client/error.hpp"
#include "asip/time.hpp"

namespace asip::client {

/// Keeps a callback registered; the callback is never called after this is destroyed or reset. May be dropped
/// inside the callback, and may outlive the board.
class Subscription {
  public:
    /// Keeps nothing.
    Subscription() = default;
    explicit Subscription(std::shared_ptr<void> registration) : registration_(std::move(registration)) {}
    Subscription(Subscription&&) noexcept = default;
    Subscription& operator=(Subscription&&) noexcept = default;

    /// Ends it now.
    void reset() { registration_.reset(); }

  private:
    std::shared_ptr<void> registration_;
};

/// Events kept in order until they are fetched, for code that must not miss one while it waits for something
/// else. Copies share one queue. It stops collecting when the last copy is gone.
template <class T>
class Stream {
  public:
    /// The newest this many are kept; what was dropped before them is counted.
    static constexpr std::size_t kCapacity = 256;

    /// A stream that is closed already.
    Stream() = default;
    explicit Stream(boost::asio::any_io_executor executor)
        : state_(std::make_shared<State>(std::move(executor))) {}

    /// The oldest event kept, waiting for one if there is none; kClosed once the board was closed. One caller
    /// at a time.
    Awaitable<T> next() const { return next_of(state_, Time::max()); }
    /// The same, but kTimeout when none came for `limit`.
    Awaitable<T> next(Duration limit) const { return next_of(state_, Clock::now() + limit); }

    /// How many events were dropped because the program did not fetch them.
    std::uint64_t dropped() const { return state_ ? state_->dropped : 0; }

    // What feeds it. Both do nothing to a stream that no program holds any more.
    struct State;
    static void push(const std::weak_ptr<State>& state, T value);
    static void close(const std::weak_ptr<State>& state);
    std::weak_ptr<State> state() const { return state_; }
    /// Keeps `owned` (the subscription that feeds it) alive as long as the stream.
    void keep(std::shared_ptr<void> owned) const { state_->owned = std::move(owned); }

  private:
    static Awaitable<T> next_of(std::shared_ptr<State> state, Time deadline);

    std::shared_ptr<State> state_;
};

template <class T>
struct Stream<T>::State {
    explicit State(boost::asio::any_io_executor executor) : arrived(std::move(executor)) {}

    boost::asio::steady_timer arrived;  // cancelled to wake the waiter
    std::deque<T> queue;
    std::uint64_t dropped = 0;
    bool closed = false;
    std::shared_ptr<void> owned;
};

template <class T>
void Stream<T>::push(const std::weak_ptr<State>& state, T value) {
    if (const auto alive = state.lock()) {
        if (alive->queue.size() == kCapacity) {
            alive->queue.pop_front();
            ++alive->dropped;
        }
        alive->queue.push_back(std::move(value));
        alive->arrived.cancel();
    }
}

template <class T>
void Stream<T>::close(const std::weak_ptr<State>& state) {
    if (const auto alive = state.lock()) {
        alive->closed = true;
        alive->arrived.cancel();
    }
}

template <class T>
Awaitable<T> Stream<T>::next_of(std::shared_ptr<State> state, Time deadline) {
    if (state) state->arrived.expires_at(deadline);
    while (state && state->queue.empty() && !state->closed && Clock::now() < deadline) {
        boost::system::error_code woken;
        co_await state->arrived.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, woken));
    }
    if (state && state->queue.empty() && !state->closed)
        co_return failure(Error::Kind::kTimeout, "no event in time");
    if (!state || state->queue.empty()) co_return failure(Error::Kind::kClosed, "the board was closed");
    Result<T> oldest = std::move(state->queue.front());
    state->queue.pop_front();
    co_return oldest;
}

}  // namespace asip::client
