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

/// Sends requests over MQTT and finds their answers: the ids and the reply topic travel inside the payload,
/// and over MQTT 5 as properties, too: a bridge between two brokers may speak 3.1.1, and drops those. A
/// command says when it was sent, by the clock of the agent that gets it, as soon as an answer of that agent
/// has told the clock. Pure: the caller publishes the request and gives what arrives to take().
class Requester {
  public:
    using OnReply = std::function<void(const mqtt::Message&)>;

    /// The interest in the answers to one request: when it ends, its callback is not called any more. May
    /// outlive the requester.
    class [[nodiscard]] Request {
      public:
        Request() = default;
        void reset() { entry_.reset(); }
        /// The id by which the answer is known; empty: none is awaited.
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

    /// `name`: unique among all programs of the bus, because ids begin with it and a repeated id is taken for
    /// a repeated request. `replies`: of this program alone.
    Requester(std::string name, ReplyTopics replies) : name_(std::move(name)), replies_(std::move(replies)) {}

    /// Where answers come. Subscribe to its filter() before the first request.
    const ReplyTopics& replies() const { return replies_; }

    struct More {
        /// For a board without an agent: over MQTT 5 the payload stays as it is.
        bool plain = false;
        /// Of a command: within what time it is to be answered.
        std::optional<std::chrono::milliseconds> deadline{};
        std::string_view by{};  ///< who asks, unless the payload says it; empty: not said
        std::string id{};       ///< of no other request that waits; empty: made here
        /// Where the answer comes; null: on the topics of all.
        const ReplyTopics* replies = nullptr;
    };

    /// Makes `message` (topic and payload are set) one that is answered. `v5`: the connection speaks MQTT 5.
    /// A payload that is not a JSON object becomes the member "raw" of one. `on_reply` is called for
    /// each answer, as several registries may answer one query, until the returned request is destroyed or
    /// reset. There is no time limit: that is the caller's.
    Request ask(mqtt::Message& message, bool v5, OnReply on_reply, Time now = Clock::now()) {
        return ask(message, v5, std::move(on_reply), now, {});
    }
    Request ask(mqtt::Message& message, bool v5, OnReply on_reply, Time now, const More& more);

    /// Give it every message that arrives. True: it was an answer, or on a topic of replies(), and is dealt
    /// with. What comes on the topic of another answerer than was asked is no answer.
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
