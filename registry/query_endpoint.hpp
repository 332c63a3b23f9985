// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "asip/bus/request/request_envelope.hpp"
#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"
#include "registry/queries.hpp"
#include "registry/waiting_questions.hpp"

namespace asip::registry {

/// Queries over MQTT: takes them out of the messages they arrive in, and puts answers into messages. What
/// comes faster than it is answered waits, and askers take turns: an asker is the USER of the topic for the
/// answer, or that topic.
class QueryEndpoint {
  public:
    using Publish = std::function<void(mqtt::Message)>;

    /// Whether an answer may go to this topic.
    using MayAnswer = std::function<bool(const std::string& topic)>;

    QueryEndpoint(Queries& queries, Publish publish, MayAnswer may_answer)
        : queries_(queries), publish_(std::move(publish)), may_answer_(std::move(may_answer)) {}

    /// The broker's limit of a packet; 0: it named none. No answer is longer than bus::kBrokerPacketBytes.
    void set_max_bytes(std::size_t bytes) {
        max_bytes_ = bytes == 0 ? bus::kBrokerPacketBytes : std::min(bytes, bus::kBrokerPacketBytes);
    }
    /// So many are answered at once, where none waits, before the next turn.
    static constexpr std::size_t kAtOnce = 8;

    /// Publishes the answer, now or later: "queue-full" where too many of this asker wait. Retained requests,
    /// and those that do not name where their answer goes, or name a topic where it may not go, are ignored.
    /// `to_any`: every registry got it. Then one that keeps a history answers what is asked of histories
    /// first, and those that keep none say so later: the asker takes the first answer.
    void request(const mqtt::Message& message, bool to_any, Time now);
    /// From now on requests to forget are refused here: they come by forget().
    void set_forget_topic(std::string topic) { forget_topic_ = std::move(topic); }
    /// A message on the topic for requests to forget.
    void forget(const mqtt::Message& message);
    /// Whether a turn is wanted, as soon as the program has read what came meanwhile.
    bool waits() const { return !waiting_.empty() || (!of_history_.empty() && !reads_history_); }
    /// Answers one question that waits, of the asker whose turn it is, and one of the history.
    void turn();
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
    void take(Question question);
    /// An asker is told so only kMaxRefused times between two ticks: a flood must cost less than it asks for.
    void refuse(std::string reason, std::string error, const bus::ReplyTo& reply);
    void answer(const Question& question);

    struct Later {
        Time due;
        mqtt::Message answer;
    };
    Queries& queries_;
    Publish publish_;
    MayAnswer may_answer_;
    std::size_t max_bytes_ = bus::kBrokerPacketBytes;
    std::size_t answered_ = 0;                    // since the last turn
    std::map<std::string, std::size_t> refused_;  // of each asker, since the last tick
    static constexpr std::size_t kMaxRefused = 64;
    WaitingQuestions<Question> waiting_;
    WaitingQuestions<Question> of_history_;  // these are read on another thread, one at a time
    bool reads_history_ = false;
    std::string forget_topic_;  // empty: queries and requests to forget come by one topic
    std::deque<Later> later_;
};

}  // namespace asip::registry
