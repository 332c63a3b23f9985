// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "asip/bus/demander.hpp"
#include "asip/bus/requester.hpp"
#include "asip/model/model_set.hpp"
#include "asip/mqtt/message.hpp"
#include "gateway/api/board_models.hpp"
#include "gateway/api/board_texts.hpp"
#include "gateway/auth/gate.hpp"
#include "gateway/commands/commands.hpp"
#include "gateway/http/server.hpp"
#include "gateway/metrics/histogram.hpp"
#include "gateway/mirror/mirror.hpp"
#include "gateway/rate.hpp"
#include "gateway/stream/streams.hpp"

namespace asip::gateway {

struct GatewayOptions {
    std::string topic_root = "asip";
    std::string user;       ///< of the broker, in reply topics
    std::string client;     ///< of this gateway alone, likewise
    std::string broker;     ///< for people
    std::string base_path;  ///< of a proxy, "/asip"; empty: none
    Duration forget_after = std::chrono::hours(7 * 24);
    ValueLimits values;
    Gate::Options gate;
    double commands_per_second = 50;  ///< of one name; bursts of twice as many
    std::size_t streams_per_client = 64;
    std::size_t subscriptions = 256;  ///< of one WebSocket
    bool page = true;
    bool metrics = true;

    /// Where what it asks is answered, on topics below.
    bus::ReplyTopics replies() const { return {bus::Topics(topic_root), user, client}; }
};

/// The gateway without its sockets: requests, messages of the bus and time go in, answers and messages come
/// out.
class Gateway {
  public:
    struct Port {
        std::function<bool(mqtt::Message)> publish;  ///< false: refused, the queue is full
        /// Whether there is a connection for what is urgent, with its answers subscribed.
        std::function<bool()> urgent_ready;
        /// Ahead of all that waits: over that connection, or first over the other.
        std::function<bool(mqtt::Message)> publish_first;
        std::function<void(std::string filter, bool retained)> subscribe;
        std::function<void(const std::string& filter)> unsubscribe;
        std::function<bool()> v5;
        std::function<Instant()> now;
        std::function<http::ServerCounters()> server;  ///< for metrics
        /// Calls back within a millisecond or two, once what is under way is done.
        std::function<void(std::function<void()>)> soon;
    };

    Gateway(GatewayOptions options, model::ModelSet models, registry::UnitsOf units_of, Random random,
            Secrets secrets, Port port);
    ~Gateway();

    void request(const http::Request& request, const http::Reply& reply);
    void subscribed();
    void disconnected();
    /// The program ends: nothing is demanded any more, and nobody waits for an answer.
    void leave();
    void message(const mqtt::Message& message);
    /// Call ten times a second.
    void tick();

    const GatewayOptions& options() const { return options_; }
    Instant now() const { return port_.now(); }
    Mirror& mirror() { return mirror_; }
    Commands& commands() { return commands_; }
    Gate& gate() { return gate_; }
    Streams& streams() { return streams_; }
    bus::Demander& demander() { return demander_; }
    Rates& command_rates() { return command_rates_; }
    /// Kept since each command needs one; bounded by whoever adds to it.
    std::unordered_map<std::string, std::string>& session_names() { return session_names_; }
    const metrics::Histogram& command_durations() const { return durations_; }
    const model::ModelSet& models() const { return models_; }
    api::BoardTexts& board_texts() { return board_texts_; }
    api::BoardModels& board_models() { return board_models_; }
    http::ServerCounters server_counters() const { return port_.server(); }
    const std::string& openapi();

    /// Publishes a command and calls `done` with its answer. A refusal by the gateway itself is an answer,
    /// too.
    void command(Commands::Start start, Commands::Done done);
    /// Asks a registry; `done` is called once, with nothing where none answered within 3 s.
    using Answered = std::function<void(const bus::Answer*)>;
    void ask_registry(const std::string& payload, Answered done);
    /// Waits for the next value of a service behind `after`: `done` is called once, after at most `limit`.
    void wait_for_value(std::unique_ptr<Feed> feed, Duration limit, std::function<void()> done);

  private:
    struct Question {
        bus::Requester::Request request;
        Answered done;
        Time until;
    };
    struct Wait {
        std::unique_ptr<Feed> feed;
        std::function<void()> done;
        Time until;
        bool ready = false;
    };
    void finish_waits();
    void finished(const CommandRecord& record, Duration time);
    void log_commands();
    void publish_all(std::vector<mqtt::Message> messages);

    GatewayOptions options_;
    Port port_;
    model::ModelSet models_;
    bus::Demander demander_;
    Mirror mirror_;
    Commands commands_;
    Gate gate_;
    Streams streams_;
    Rates command_rates_;
    api::BoardTexts board_texts_;
    api::BoardModels board_models_{models_};
    std::unordered_map<std::string, std::string> session_names_;
    metrics::Histogram durations_;
    std::vector<const CommandRecord*> to_log_;  // of commands_, which keeps them for a minute
    bus::Requester requester_;
    std::list<Question> questions_;
    std::list<Wait> waits_;
    std::string openapi_;
};

}  // namespace asip::gateway
