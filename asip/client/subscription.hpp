// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <utility>

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

}  // namespace asip::client
