// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/bus_session.hpp"

#include "cli/ask/board_request.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <map>
#include <set>
#include <utility>

#include "asip/mqtt/failure.hpp"
#include "asip/program/stop_signal.hpp"
#include "asip/random.hpp"
#include "cli/ask/quit_key.hpp"
#include "cli/ask/stuck_output.hpp"

namespace asip::cli {

using namespace std::chrono_literals;

namespace {

/// Every broker that lives has done it by then.
constexpr auto kTimeToAcknowledge = 1s;

/// Some brokers meet MQTT 5 with silence. One call tries 3.1.1, too, within the time that it has.
mqtt::Options with_time_for_both_versions(mqtt::Options options) {
    if (options.version == mqtt::Version::kBest) options.connect_timeout /= 2;
    return options;
}

}  // namespace

struct BusSession::State {
    explicit State(const Environment& its_environment)
        : environment(its_environment),
          name(random_hex(system_random(), 12)),
          requester(name, bus::ReplyTopics(environment.topics, environment.mqtt.user, name)),
          demander(environment.topics, environment.mqtt.user, name, system_random()),
          signal(io,
                 [this](int) {
                     stopped = true;
                     not_stuck();
                 }),
          client(io, with_time_for_both_versions(environment.mqtt), handlers()),
          router([this](const std::string& filter) { client.unsubscribe(filter); }) {
        end_when_stuck();
        for (const auto& broker : environment.mqtt.brokers)
            brokers.insert(broker.describe());
    }

    mqtt::Client::Handlers handlers() {
        mqtt::Client::Handlers result;
        result.on_connected = [this](const mqtt::Connected& connected) {
            max_packet_bytes = connected.max_packet_bytes;
            connected_again();
        };
        result.on_disconnected = [this](const mqtt::ConnectionFailure& why) {
            demander.disconnected();
            why_lost = why.text;
            // Of a message that is not acknowledged brokers do not tell that they denied it: Mosquitto 2.0.11
            // closes the connection. One end may be that of the broker itself.
            const bool denying = why.after_sending > 1 && !last_topic.empty();
            if (why.after_sending > 0 && !last_topic.empty()) cut_off_by = last_topic;
            if (!connection_changed) return;
            connection_changed(false,
                               denying ? mqtt::cut_off_text(environment.mqtt.user, last_topic) : why.text);
        };
        result.on_connect_failed = [this](const mqtt::ConnectionFailure& why) {
            failed[why.broker.describe()] = why;
        };
        result.on_message = [this](const mqtt::Message& message) { dispatch(message); };
        result.on_published = [this](const std::string&) { ++acknowledged; };
        result.on_publish_denied = [this](const std::string& topic, const std::string& reason) {
            if (!denied.insert(topic).second) return;
            environment.note(mqtt::denied_text(environment.mqtt.user, topic, reason));
        };
        result.on_subscribe_refused = [this](const std::string& filter, const std::string& reason) {
            if (!tells_refusals) return;
            const auto& user = environment.mqtt.user;
            environment.note("the broker does not let " + (user.empty() ? "users without a name" : user) +
                             " read " + filter + " (" + reason + "): what comes there is missing");
        };
        return result;
    }

    void connected_again() {
        demander.connected(Clock::now());
        why_lost.reset();
        const bool first = !std::exchange(was_connected, true);
        if (!first && connection_changed) connection_changed(true, {});
    }

    /// Each broker of the list is out of reach or has refused: waiting for another attempt is useless.
    bool no_broker_left() const {
        return failed.size() == brokers.size() &&
               std::all_of(failed.begin(), failed.end(), [](const auto& one) {
                   const auto& why = one.second;
                   return why.fatal() || why.kind == mqtt::ConnectionFailure::Kind::kUnreachable;
               });
    }

    std::string why_not_connected() const {
        std::string text;
        for (const auto& [broker, why] : failed)
            text += (text.empty() ? "" : "; ") + why.text;
        return text;
    }

    void dispatch(const mqtt::Message& message) {
        if (requester.take(message)) return;
        demander.take(message, Clock::now());
        router.dispatch(message);
        if (message.retain) retained_at = Clock::now();
    }

    Request ask(mqtt::Message message, OnMessage on_reply, const bus::Requester::More& more) {
        auto request = requester.ask(message, client.v5(), std::move(on_reply), Clock::now(), more);
        last_topic = message.topic;
        refused_in_silence = client.v5() && message.qos > 0 ? std::nullopt : std::optional(last_topic);
        client.publish(std::move(message), mqtt::Priority::kReply);
        return request;
    }

    void publish_demands(std::vector<mqtt::Message> demands) {
        for (auto& demand : demands)
            client.publish(std::move(demand), mqtt::Priority::kReply);
    }

    const Environment& environment;
    std::string name;
    bus::Requester requester;
    bus::Demander demander;
    boost::asio::io_context io{1};
    bool stopped = false;
    std::size_t max_packet_bytes = 0;
    bool was_connected = false;
    bool leaving = false;
    bool left = false;
    std::size_t acknowledged = 0;
    std::set<std::string> brokers;
    std::map<std::string, mqtt::ConnectionFailure> failed;  // the last failure of each broker
    bool tells_refusals = false;
    std::set<std::string> denied;
    std::string last_topic;  // that was published on
    // The last request, where a broker that denies it says nothing: MQTT 3.1.1, or QoS 0.
    std::optional<std::string> refused_in_silence;
    std::optional<std::string> cut_off_by;  // right behind a message on this topic the connection was closed
    std::optional<std::string> why_lost;    // while there is no connection, and was one
    std::function<void(bool, const std::string&)> connection_changed = [this](bool connected,
                                                                              const std::string& why) {
        environment.note(connected ? "connected again" : why);
    };
    std::size_t marks = 0;
    Time retained_at{};  // when something retained last came
    bool started = false;
    program::StopSignal signal;
    std::optional<QuitKey> quit_key;
    mqtt::Client client;
    mqtt::Router router;  // ends before the client that it unsubscribes from
};

BusSession::BusSession(const Environment& environment) : state_(std::make_unique<State>(environment)) {
    state_->client.subscribe(state_->requester.replies().filter(),
                             {.qos = 0, .no_local = false, .retained = false});
}

BusSession::~BusSession() {
    if (state_->leaving) return;
    leave();
    while (state_->leaving && !state_->left && state_->io.run_one_for(400ms) != 0) {
    }
}

void BusSession::leave() {
    if (!state_->was_connected || std::exchange(state_->leaving, true)) return;
    state_->publish_demands(state_->demander.leave());
    state_->client.stop(300ms, [state = state_.get()] { state->left = true; });
    state_->io.poll();
}

void BusSession::end_at_q() {
    state_->quit_key.emplace(state_->io, [state = state_.get()] { state->stopped = true; });
}

BusSession::Subscription BusSession::subscribe(const std::string& filter, OnMessage on_message,
                                               mqtt::SubscribeOptions options) {
    auto subscription = state_->router.add(filter, std::move(on_message));
    state_->client.subscribe(filter, options);
    return subscription;
}

Outcome<void> BusSession::connect() {
    if (!std::exchange(state_->started, true)) state_->client.start();
    run_until([this] { return state_->was_connected || state_->no_broker_left(); },
              Clock::now() + state_->environment.mqtt.connect_timeout);
    if (state_->was_connected) return {};
    if (state_->stopped) return interrupted();
    if (!state_->failed.empty()) return failure(program::kExitBroker, state_->why_not_connected());
    return failure(program::kExitBroker,
                   "the broker does not answer; is --broker right? Try: asipctl doctor");
}

std::size_t BusSession::max_packet_bytes() const {
    return state_->max_packet_bytes;
}

bool BusSession::v5() const {
    return state_->client.v5();
}

void BusSession::publish(const std::string& topic, const std::string& payload, int qos, bool retain) {
    mqtt::Message message;
    message.topic = topic;
    message.payload = payload;
    message.qos = qos;
    message.retain = retain;
    state_->last_topic = topic;
    state_->client.publish(std::move(message), mqtt::Priority::kReply);
}

BusSession::Request BusSession::ask(const std::string& topic, const std::string& payload, OnMessage on_reply,
                                    int qos, bool plain) {
    mqtt::Message message;
    message.topic = topic;
    message.payload = payload;
    message.qos = qos;
    return state_->ask(std::move(message), std::move(on_reply), {.plain = plain});
}

BusSession::Request BusSession::command(const std::string& topic, const std::string& payload,
                                        OnMessage on_reply, bool plain) {
    mqtt::Message message;
    message.topic = topic;
    message.payload = payload;
    message.qos = 1;
    message.expire_after(state_->environment.timeout);
    // For histories. What names its sender itself stays as it is.
    if (v5() && !plain && payload.find("\"by\":") == std::string::npos)
        message.user_properties = {{"by", who_asks(state_->environment)}};
    return state_->ask(std::move(message), std::move(on_reply),
                       {.plain = plain, .deadline = state_->environment.timeout});
}

bus::Demander::Want BusSession::want(const std::string& board, const std::string& service, double hz) {
    return state_->demander.want(board, service.empty() ? "*" : service, hz);
}

BusSession::Demand BusSession::demand(const std::string& board, const std::string& service, double hz) {
    const bool pattern = board.find_first_of("*?") != std::string::npos;
    return {
        subscribe(state_->environment.topics.description(pattern ? "+" : board), [](const mqtt::Message&) {}),
        want(board, service, hz)};
}

BusSession::Mark BusSession::mark_retained() {
    const auto topic = state_->requester.replies().below("mark" + std::to_string(++state_->marks)).own();
    Mark mark;
    mark.at_ = std::make_shared<std::optional<Time>>();
    mark.subscription_ = subscribe(topic, [at = mark.at_](const mqtt::Message&) {
        if (!*at) *at = Clock::now();
    });
    publish(topic, "mark");
    return mark;
}

void BusSession::wait_retained(const std::function<bool()>& enough, Duration patience) {
    const auto began = Clock::now();
    const auto mark = mark_retained();
    const auto over = [&] {
        const auto last = std::max(state_->retained_at, mark.passed_at().value_or(began));
        return Clock::now() - last >= (mark.passed() ? Duration(kRetainedPatience) : patience);
    };
    run_until([&] { return enough() || over(); }, Time::max());
}

bool BusSession::run_until(const std::function<bool()>& done, Time deadline) {
    while (!done()) {
        if (state_->environment.output_ended()) state_->stopped = true;
        if (state_->stopped) return false;
        const auto left = deadline - Clock::now();
        if (left <= Duration::zero()) return false;
        state_->publish_demands(state_->demander.due(Clock::now()));
        // `done` may wait for time to pass, too.
        state_->io.run_one_for(std::min<Duration>(left, 20ms));
    }
    return true;
}

bool BusSession::run_to_end(const std::function<bool()>& done, Duration patience) {
    const auto deadline = Clock::now() + patience;
    while (!done()) {
        const auto left = deadline - Clock::now();
        if (left <= Duration::zero()) return false;
        state_->io.run_one_for(std::min<Duration>(left, 20ms));
    }
    return true;
}

std::size_t BusSession::acknowledged() const {
    return state_->acknowledged;
}

bool BusSession::stopped() const {
    return state_->stopped;
}

void BusSession::on_connection_change(std::function<void(bool, const std::string&)> handler) {
    state_->connection_changed = std::move(handler);
}

bool BusSession::lost() const {
    return state_->why_lost.has_value();
}

Outcome<void> BusSession::heard_all() const {
    if (stopped()) return interrupted();
    if (lost()) return tl::unexpected(unanswered({}));
    return {};
}

Failure BusSession::unanswered(std::string text) const {
    if (lost()) return {program::kExitBroker, *state_->why_lost + ", and was not back in time"};
    if (state_->environment.timeout >= kTimeToAcknowledge && state_->client.counters().unacknowledged != 0)
        return {program::kExitBroker,
                "the broker does not acknowledge what it is sent; does it stand still?"};
    // It came back without an answer: a broker that only restarted is the rarer reason.
    if (state_->cut_off_by)
        text += "; " + mqtt::cut_off_text(state_->environment.mqtt.user, *state_->cut_off_by);
    else if (const auto& topic = state_->refused_in_silence; topic && !text.empty())
        text += mqtt::unanswered_text(state_->environment.mqtt.user, *topic,
                                      topic->ends_with("/query") ? "viewer NAME" : "operator NAME");
    return {program::kExitNoAnswer, std::move(text)};
}

bool BusSession::denied(const std::string& topic) const {
    return state_->denied.contains(topic);
}

void BusSession::tell_refused_subscriptions() {
    state_->tells_refusals = true;
}

}  // namespace asip::cli
