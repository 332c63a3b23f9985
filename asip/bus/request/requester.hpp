// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "asip/bus/request/agent_clock.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"

namespace asip::bus {

/// Sends requests over MQTT and finds their answers. Ids and reply topic travel inside the payload and, over
/// MQTT 5, as properties, which bridges that speak 3.1.1 drop. A command says when it was sent, once its
/// agent's clock is known. Pure: the caller publishes requests and passes what arrives to take().
class Requester {
  public:
    using OnReply = std::function<void(const mqtt::Message&)>;

    /// The interest in the answers to a request: its end ends the callback. May outlive the requester.
    class [[nodiscard]] Request {
      public:
        Request() = default;
        void reset() { entry_.reset(); }
        /// Empty: no answer is awaited.
        const std::string& id() const;

      private:
        friend class Requester;
        struct Entry {
            std::string id;
            std::string reply_topic;
            OnReply on_reply;
            std::string clock_of;  // the board; empty: it is no command
            Time asked;            // its answer tells the agent's clock
        };
        explicit Request(std::shared_ptr<Entry> entry) : entry_(std::move(entry)) {}
        std::shared_ptr<Entry> entry_;
    };

    /// `name`: unique on the bus, because a repeated id is a repeated request. `replies`: this program's
    /// alone.
    Requester(std::string name, ReplyTopics replies) : name_(std::move(name)), replies_(std::move(replies)) {}

    /// Subscribe to its filter() before the first request.
    const ReplyTopics& replies() const { return replies_; }

    struct More {
        /// Over MQTT 5 the payload of a request to a board without agent stays as it is.
        bool plain = false;
        /// Within what time a command is to be answered.
        std::optional<std::chrono::milliseconds> deadline{};
        std::string_view by{};  ///< who asks, unless the payload says it; empty: not said
        std::string id{};       ///< of no other request that waits; empty: made here
        /// Null: the topics of all.
        const ReplyTopics* replies = nullptr;
    };

    /// Makes `message` (topic and payload are set) a request. A payload that is no JSON object becomes its
    /// member "raw". `on_reply` is called for each answer, as several registries may answer, until the
    /// request is destroyed or reset. The caller has the time limit.
    Request ask(mqtt::Message& message, bool v5, OnReply on_reply, Time now = Clock::now()) {
        return ask(message, v5, std::move(on_reply), now, {});
    }
    Request ask(mqtt::Message& message, bool v5, OnReply on_reply, Time now, const More& more);

    /// For every message that arrives. True: an answer, or on a topic of replies(). Only who was asked can
    /// answer.
    bool take(const mqtt::Message& message, Time now = Clock::now());

  private:
    std::string name_;
    ReplyTopics replies_;
    std::size_t last_ = 0;
    std::map<std::string, std::weak_ptr<Request::Entry>, std::less<>> open_;
    std::size_t sweep_at_ = 0;  // so many, ended ones among them
    AgentClocks clocks_;        // by board
};

}  // namespace asip::bus
