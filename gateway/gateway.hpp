// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "asip/caller/caller.hpp"
#include "asip/model/model_set.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"
#include "gateway/api/board_models.hpp"
#include "gateway/api/many_boards.hpp"
#include "gateway/api/things.hpp"
#include "gateway/auth/gate.hpp"
#include "gateway/cable/cable_way.hpp"
#include "gateway/commands/commands.hpp"
#include "gateway/dashboard/dashboards.hpp"
#include "gateway/http/server.hpp"
#include "gateway/metrics/command_times.hpp"
#include "gateway/mirror/mirror.hpp"
#include "gateway/stream/streams.hpp"

namespace asip::gateway {

/// Another system that boards can be shown to.
struct ExportStanding {
    std::string system;  ///< as `asip-gateway export` calls it
    std::string title;   ///< "Home Assistant"
    bool on = false;     ///< this gateway has the option
    bool shows = false;  ///< it shows boards there now
    std::string other;   ///< the machine of another gateway that does; empty: none
    /// Whether the system said that it is there, or has left; nothing: it said neither.
    std::optional<bool> found;
};

/// How often each name may do something: `per_second` on average, twice as many at once. Pure.
class Rates {
  public:
    explicit Rates(double per_second) : per_second_(per_second) {}

    /// False: too many.
    bool take(const std::string& name, Time now) {
        auto& bucket = buckets_.try_emplace(name, Bucket{2 * per_second_, now}).first->second;
        const std::chrono::duration<double> passed = now - bucket.at;
        bucket.left = std::min(2 * per_second_, bucket.left + passed.count() * per_second_);
        bucket.at = now;
        if (bucket.left < 1) return false;
        bucket.left -= 1;
        return true;
    }
    /// Forgets names that did nothing for a minute.
    void expire(Time now) {
        std::erase_if(buckets_,
                      [&](const auto& each) { return now - each.second.at > std::chrono::minutes(1); });
    }

  private:
    struct Bucket {
        double left;
        Time at;
    };
    double per_second_;
    std::map<std::string, Bucket> buckets_;
};

/// Limits hold for all connections of a client together: a token, or an address without one.
struct GatewayOptions {
    std::string topic_root = "asip";
    std::string user;                                    ///< of the broker, in reply topics
    std::string client;                                  ///< of this gateway alone, likewise
    std::string broker;                                  ///< for people
    std::string base_path;                               ///< of a proxy, "/asip"; empty: none
    Duration forget_after = std::chrono::hours(7 * 24);  ///< a board that is not alive; as a registry's
    ValueLimits values;
    Gate::Options gate;                   ///< which requests are ours, and what may be done without a token
    double commands_per_second = 50;      ///< of one name; bursts of twice as many
    std::size_t streams_per_client = 64;  ///< waits for a value among them
    std::size_t subscriptions = 256;      ///< of one WebSocket
    std::size_t client_bytes = std::size_t{32} << 20;  ///< all that one client may have kept: Budget
    std::size_t socket_bytes = 96 * 1024;  ///< what a WebSocket takes of that: its message and buffers
    bool page = true;
    bool metrics = true;
    bool simulator = false;  ///< its machine has asip-sim
    api::ThingsOptions things;

    /// On topics below it.
    bus::ReplyTopics replies() const { return {bus::Topics(topic_root), user, client}; }
};

/// The gateway without its sockets: requests, messages and time go in, answers and messages come out. One
/// thread. Sources and channels of open connections refer to it.
class Gateway {
  public:
    /// Called on its thread; only what `soon` is given may call back at once.
    struct Port {
        /// Commands, questions and demands, over a connection for answers alone. `publish_first`: over the
        /// urgent connection, or first over this.
        caller::Caller::Port calls{};
        std::function<bool(mqtt::Message)> publish{};  ///< false: refused, the queue is full
        std::function<void(const std::string& filter, bool retained)> subscribe{};
        std::function<void(const std::string& filter)> unsubscribe{};
        /// The urgent connection is there, with its answers subscribed.
        std::function<bool()> urgent_ready{};
        std::function<Instant()> now{};                  ///< never earlier than before
        std::function<http::ServerCounters()> server{};  ///< for metrics
        std::function<std::vector<ExportStanding>()> exports{};
        /// Begins a cable; empty: no agent takes lent boards.
        std::function<std::unique_ptr<CableWay>(CableWay::Handlers)> cable{};
        /// Calls back within a millisecond or two, behind what is under way.
        std::function<void(std::function<void()>)> soon{};
    };

    /// `units_of`: for queries. `random`: for names on the bus and times; `secrets`: for codes and cookies
    /// alone. Nothing is published before subscribed().
    Gateway(GatewayOptions options, model::ModelSet models, catalogue::UnitsOf units_of, Random random,
            Secrets secrets, Port port);
    ~Gateway();

    /// Answers `reply` once, before it returns or later. A bad request only gets a status of 400 and above.
    void request(const http::Request& request, const http::Reply& reply);
    /// By the same rights.
    http::Asker asker_of(const http::Request& request);
    /// Filter, and whether what is retained is wanted.
    std::vector<std::pair<std::string, bool>> subscriptions() const;
    /// The broker has granted subscriptions().
    void subscribed();
    /// What is known is still served, and said to be old.
    void disconnected();
    /// The connection for commands, questions and answers is there, or is lost.
    void can_call() { caller_.connected(now().time); }
    void cannot_call(const mqtt::ConnectionFailure& why) { caller_.disconnected(why, now().time); }
    /// A client may wait for the message's answer.
    void denied(const std::string& topic, const std::string& reason) { caller_.denied(topic, reason); }
    /// Nothing is demanded any more, and no client waits.
    void leave();
    void message(const mqtt::Message& message);
    /// From the connections for commands, questions and stops. False: it answers nothing.
    bool answer(const mqtt::Message& message);
    /// Ten times a second: leases, deadlines, waits and rights end by it.
    void tick();

    // Its parts, for the API. References are valid as long as the gateway.
    const GatewayOptions& options() const { return options_; }
    Instant now() const { return port_.now(); }
    Mirror& mirror() { return mirror_; }
    Dashboards& dashboards() { return dashboards_; }
    Commands& commands() { return commands_; }
    Gate& gate() { return gate_; }
    Streams& streams() { return streams_; }
    Budget& budget() { return budget_; }
    caller::Caller& caller() { return caller_; }
    Rates& command_rates() { return command_rates_; }
    Rates& log_rates() { return log_rates_; }  ///< lines of the log about what a client changed
    /// A client's session -> a level of a topic. The one place that adds to it bounds it.
    std::unordered_map<std::string, std::string>& session_names() { return session_names_; }
    /// Exports left these values out.
    void count_refused_values(std::uint64_t values) { refused_values_ += values; }
    std::uint64_t refused_values() const { return refused_values_; }
    const metrics::CommandTimes& command_durations() const { return durations_; }
    const model::ModelSet& models() const { return models_; }
    api::BoardTexts& board_texts() { return board_texts_; }
    api::BoardModels& board_models() { return board_models_; }
    api::Things& things() { return things_; }
    api::ManyBoards& many_boards() { return many_boards_; }
    http::ServerCounters server_counters() const { return port_.server(); }
    std::vector<ExportStanding> exports() const { return port_.exports(); }
    bool has_cables() const { return static_cast<bool>(port_.cable); }
    std::unique_ptr<CableWay> cable(CableWay::Handlers handlers) { return port_.cable(std::move(handlers)); }
    /// As JSON, made once.
    const std::string& openapi();

    /// `done` is called once with the answer, half a second behind the deadline at the latest; a refusal by
    /// the gateway is one. The record is valid for the call only.
    void command(Commands::Start start, Commands::Done done);
    /// `done` is called once; nothing: no registry answered within 3 s. The wait is counted to `client`.
    /// False: there is no room, and `done` is not called.
    using Answered = std::function<void(const bus::Answer*)>;
    bool ask_registry(const std::string& payload, const std::string& client, Answered done,
                      std::string topic = {});
    /// Waits for the next value, at most `limit`, as a stream of its client. `done` is called once, with true
    /// when the right was taken back; not where no client waits any more.
    void wait_for_value(std::unique_ptr<Feed> feed, Duration limit, const http::Reply& reply,
                        const Principal& principal, const std::string& client,
                        std::function<void(bool revoked)> done);

  private:
    struct Question {
        caller::Caller::Question request;
        Answered done;
        Time until;
        Budget::Part part;
    };
    struct Wait;
    void finish_waits(bool all);
    void finished(const CommandRecord& record, Duration time);
    void log_commands();
    void read_dashboards();

    GatewayOptions options_;
    Port port_;
    model::ModelSet models_;
    caller::Caller caller_;
    Mirror mirror_;
    Dashboards dashboards_;
    Commands commands_;
    Gate gate_;
    Budget budget_;
    Streams streams_;
    Rates command_rates_;
    Rates log_rates_;
    api::BoardTexts board_texts_;
    api::BoardModels board_models_{models_};
    api::Things things_{options_.things, models_};
    api::ManyBoards many_boards_{*this};
    std::unordered_map<std::string, std::string> session_names_;
    metrics::CommandTimes durations_;
    std::vector<const CommandRecord*> to_log_;  // of commands_, which keeps them for a minute
    std::list<Question> questions_;
    std::list<std::unique_ptr<Wait>> waits_;
    std::uint64_t refused_values_ = 0;
    bool wait_ready_ = false;  // some of them is
    std::string openapi_;
};

}  // namespace asip::gateway
