// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "asip/bus/request/asker_turns.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"
#include "registry/queries.hpp"

namespace asip::registry {

/// Takes queries out of MQTT messages and puts answers into them. Excess queries wait, and askers take turns:
/// an asker is the USER of the answer's topic, or that topic.
class QueryEndpoint {
  public:
    using Publish = std::function<void(mqtt::Message)>;

    using MayAnswer = std::function<bool(const std::string& topic)>;
    using TakesAnswers = std::function<bool()>;

    /// While `takes_answers` says no, questions wait.
    QueryEndpoint(
        Queries& queries, Publish publish, MayAnswer may_answer,
        TakesAnswers takes_answers = [] { return true; })
        : queries_(queries),
          publish_(std::move(publish)),
          may_answer_(std::move(may_answer)),
          takes_answers_(std::move(takes_answers)) {}

    /// The broker's limit of a packet; 0: none. bus::kBrokerPacketBytes holds besides.
    void set_max_bytes(std::size_t bytes) {
        max_bytes_ = bytes == 0 ? bus::kBrokerPacketBytes : std::min(bytes, bus::kBrokerPacketBytes);
    }
    /// So many are answered at once before the next turn.
    static constexpr std::size_t kAtOnce = 8;

    /// Publishes the answer, now or later: "queue-full" where too many of this asker wait. Retained requests,
    /// and those without an answer's topic that is allowed, are ignored. `to_any`: every registry got it;
    /// then one with a history answers for histories first, since the asker takes the first answer.
    void request(const mqtt::Message& message, bool to_any, Time now);
    /// From now on requests to forget come by forget() alone.
    void set_forget_topic(std::string topic) { forget_topic_ = std::move(topic); }
    void forget(const mqtt::Message& message);
    /// Call turn() as soon as what came meanwhile is read.
    bool waits() const {
        return (!waiting_.empty() || (!of_history_.empty() && !reads_history_)) && takes_answers_();
    }
    /// Answers one waiting question, and one of the history.
    void turn();
    void tick(Time now);

  private:
    struct Question {
        bus::ReplyTo reply;
        Queries::Request request;
    };
    /// None: no requester is to be answered, or it was.
    std::optional<Question> read(const mqtt::Message& message);
    /// It would be refused, and nothing more is said to its asker before the next tick: it is not worth
    /// reading.
    bool floods(const mqtt::Message& message) const;
    void publish(bus::Answer answer, const bus::ReplyTo& reply);
    void take(Question question);
    /// At most kMaxRefused times between two ticks: a flood must cost less than it asks for.
    void refuse(std::string reason, std::string error, const bus::ReplyTo& reply);
    void answer(const Question& question);

    struct Later {
        Time due;
        mqtt::Message answer;
    };
    Queries& queries_;
    Publish publish_;
    MayAnswer may_answer_;
    TakesAnswers takes_answers_;
    std::size_t max_bytes_ = bus::kBrokerPacketBytes;
    std::size_t answered_ = 0;                    // since the last turn
    std::map<std::string, std::size_t> refused_;  // of each asker, since the last tick
    static constexpr std::size_t kMaxRefused = 64;
    bus::AskerTurns<Question> waiting_;
    bus::AskerTurns<Question> of_history_;  // these are read on another thread, one at a time
    bool reads_history_ = false;
    std::string forget_topic_;  // empty: queries and requests to forget come by one topic
    std::deque<Later> later_;
};

}  // namespace asip::registry
