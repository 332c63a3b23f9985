// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "asip/mqtt/message.hpp"

namespace asip::mqtt {

/// Hands each message to the parts of a program that asked for it. Each registration is a handle: when it
/// ends, its callback ends with it, so that a callback may refer to whatever owns the handle.
///
/// Handles may outlive the router, and may be made and ended inside callbacks: one that has ended is not
/// called any more, not even for the message that is being dispatched. One thread.
class Router {
  public:
    using OnMessage = std::function<void(const Message&)>;
    /// Called when the last handle for this filter has ended: the moment to unsubscribe.
    using OnUnused = std::function<void(const std::string& filter)>;

    class [[nodiscard]] Subscription {
      public:
        Subscription() = default;
        void reset() { entry_.reset(); }

      private:
        friend class Router;
        explicit Subscription(std::shared_ptr<void> entry) : entry_(std::move(entry)) {}
        std::shared_ptr<void> entry_;

      public:
        Subscription(Subscription&&) = default;
        Subscription& operator=(Subscription&&) = default;
    };

    explicit Router(OnUnused on_unused = {});

    /// `filter` as MQTT matches it: `+` one level, `#` the rest. Subscribing at the broker is left to the
    /// caller.
    Subscription add(std::string filter, OnMessage on_message);
    /// Calls every callback whose filter matches, in the order in which they were added.
    void dispatch(const Message& message);

  private:
    struct State;
    std::shared_ptr<State> state_;
};

/// Whether MQTT delivers `topic` to a subscription to `filter`. False for a filter or topic that is not
/// valid.
bool topic_matches(const std::string& filter, const std::string& topic);

}  // namespace asip::mqtt
