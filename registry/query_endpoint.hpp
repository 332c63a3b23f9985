// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <optional>

#include "asip/bus/request/request_envelope.hpp"
#include "asip/mqtt/message.hpp"
#include "registry/queries.hpp"

namespace asip::registry {

/// Queries over MQTT: takes them out of the messages they arrive in, and puts answers into messages.
class QueryEndpoint {
  public:
    using Publish = std::function<void(mqtt::Message)>;

    /// Whether an answer may go to this topic.
    using MayAnswer = std::function<bool(const std::string& topic)>;

    QueryEndpoint(Queries& queries, Publish publish, MayAnswer may_answer)
        : queries_(queries), publish_(std::move(publish)), may_answer_(std::move(may_answer)) {}

    /// The broker's limit of a packet; 0: none.
    void set_max_bytes(std::size_t bytes) { max_bytes_ = bytes; }

    /// Publishes the answer, now or later. Retained requests, and those that do not name where their answer
    /// goes, or name a topic where it may not go, are ignored. `to_any`: every registry got it. Then one that
    /// keeps a history answers what is asked of histories first, and those that keep none say so later: the
    /// asker takes the first answer.
    void request(const mqtt::Message& message, bool to_any, Time now);
    /// From now on requests to forget are refused here: they come by forget().
    void set_forget_topic(std::string topic) { forget_topic_ = std::move(topic); }
    /// A message on the topic for requests to forget.
    void forget(const mqtt::Message& message);
    /// Call a few times a second.
    void tick(Time now);

  private:
    struct Question {
        bus::ReplyTo reply;
        Queries::Request request;
    };
    /// None: no requester is to be answered, or it was answered already.
    std::optional<Question> read(const mqtt::Message& message);
    void publish(bus::Answer answer, const bus::ReplyTo& reply);

    struct Later {
        Time due;
        mqtt::Message answer;
    };
    Queries& queries_;
    Publish publish_;
    MayAnswer may_answer_;
    std::size_t max_bytes_ = 0;
    std::string forget_topic_;  // empty: queries and requests to forget come by one topic
    std::deque<Later> later_;
};

}  // namespace asip::registry
