// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "asip/mqtt/message.hpp"

namespace asip::mqtt {

/// Hands messages to the parts of a program that asked for them. A registration is a handle: its end ends its
/// callback, even for the message that is being dispatched. Handles may outlive the router, and be made and
/// ended inside callbacks. One thread.
class Router {
  public:
    using OnMessage = std::function<void(const Message&)>;
    /// The last handle for this filter has ended: unsubscribe.
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

    /// `filter` as in MQTT. The caller subscribes at the broker.
    Subscription add(std::string filter, OnMessage on_message);
    /// In the order in which callbacks were added.
    void dispatch(const Message& message);

  private:
    struct State;
    std::shared_ptr<State> state_;
};

/// As MQTT delivers. False where either is not valid.
bool topic_matches(const std::string& filter, const std::string& topic);

}  // namespace asip::mqtt
