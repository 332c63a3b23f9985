// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/bus_session.hpp"

#include "cli/ask/board_request.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "asip/caller/caller.hpp"
#include "asip/model/model_set.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/mqtt/failure.hpp"
#include "asip/program/stop_signal.hpp"
#include "asip/random.hpp"
#include "cli/ask/stuck_output.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {

using namespace std::chrono_literals;

namespace {

/// Some brokers meet MQTT 5 with silence. One call tries 3.1.1, too, within the time that it has.
mqtt::Options with_time_for_both_versions(mqtt::Options options) {
    if (options.version == mqtt::Version::kBest) options.connect_timeout /= 2;
    return options;
}

}  // namespace

struct BusSession::State {
    explicit State(const Environment& its_environment)
        : environment(its_environment),
          signal(io,
                 [this](int) {
                     stopped = true;
                     not_stuck();
                 }),
          client(io, with_time_for_both_versions(environment.mqtt), handlers()),
          caller({environment.topics, environment.mqtt.user, random_hex(system_random(), 12),
                  [this](std::string_view reference) {
                      return model::units_of(environment.models(), reference);
                  },
                  0},
                 system_random(), port()) {
        end_when_stuck();
        for (const auto& broker : environment.mqtt.brokers)
            brokers.insert(broker.describe());
    }

    caller::Caller::Port port() {
        auto result = caller::port_of(client);
        result.changed = [this](const std::string& board, const mqtt::Message* said) {
            if (board_said) board_said(board, said);
        };
        return result;
    }

    mqtt::Client::Handlers handlers() {
        mqtt::Client::Handlers result;
        result.on_connected = [this](const mqtt::Connected& connected) {
            max_packet_bytes = connected.max_packet_bytes;
            connected_again();
        };
        result.on_disconnected = [this](const mqtt::ConnectionFailure& why) {
            caller.disconnected(why, Clock::now());
            if (!connection_changed) return;
            const auto& access = caller.access();
            connection_changed(false, access.denies()
                                          ? mqtt::cut_off_text(environment.mqtt.user, access.last_topic())
                                          : why.text);
        };
        result.on_connect_failed = [this](const mqtt::ConnectionFailure& why) {
            failed[why.broker.describe()] = why;
        };
        result.on_message = [this](const mqtt::Message& message) { caller.message(message, Clock::now()); };
        result.on_published = [this](const std::string&) { ++acknowledged; };
        result.on_publish_denied = [this](const std::string& topic, const std::string& reason) {
            const bool is_told = caller.denied(topic, reason);
            if (!denied.insert(topic).second || is_told) return;
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
        caller.connected(Clock::now());
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
        return listed(failed, "; ", [](const auto& one) { return one.second.text; });
    }

    /// What the user of asipctl leaves to it.
    void complete(caller::Command& command) const {
        if (!command.lasts) command.deadline = environment.timeout;
        if (command.by.empty()) command.by = who_asks(environment);
        if (command.silence.empty())
            command.silence = "no answer within " + std::to_string(command.deadline.count()) + " ms";
    }

    const Environment& environment;
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
    std::function<void(bool, const std::string&)> connection_changed = [this](bool connected,
                                                                              const std::string& why) {
        environment.note(connected ? "connected again" : why);
    };
    std::function<void(const std::string&, const mqtt::Message*)> board_said;
    bool started = false;
    program::StopSignal signal;
    mqtt::Client client;
    caller::Caller caller;  // ends before the client that it acts through
};

BusSession::BusSession(const Environment& environment) : state_(std::make_unique<State>(environment)) {}

BusSession::~BusSession() {
    if (state_->leaving) return;
    leave();
    while (state_->leaving && !state_->left && state_->io.run_one_for(400ms) != 0) {
    }
}

void BusSession::leave() {
    if (!state_->was_connected || std::exchange(state_->leaving, true)) return;
    state_->caller.leave();
    state_->client.stop(300ms, [state = state_.get()] { state->left = true; });
    state_->io.poll();
}

BusSession::Subscription BusSession::subscribe(const std::string& filter, OnMessage on_message,
                                               mqtt::SubscribeOptions options) {
    return state_->caller.subscribe(filter, std::move(on_message), options);
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
    state_->caller.publish(mqtt::Message{.topic = topic, .payload = payload, .qos = qos, .retain = retain});
}

BusSession::Request BusSession::ask(const std::string& topic, const std::string& payload, OnMessage on_reply,
                                    int qos, bool plain) {
    return state_->caller.ask(mqtt::Message{.topic = topic, .payload = payload, .qos = qos},
                              std::move(on_reply), Clock::now(), plain);
}

BusSession::Call BusSession::command(caller::Command command, OnAnswer on_answer) {
    state_->complete(command);
    return state_->caller.command(std::move(command), std::move(on_answer), Clock::now());
}

BusSession::Hold BusSession::hold(caller::Command command, std::chrono::milliseconds hold, OnAnswer begun,
                                  OnAnswer ended) {
    state_->complete(command);
    return state_->caller.hold(std::move(command), hold, std::move(begun), std::move(ended), Clock::now());
}

void BusSession::on_board(std::function<void(const std::string&, const mqtt::Message*)> handler) {
    state_->board_said = std::move(handler);
}

caller::Caller& BusSession::caller() const {
    return state_->caller;
}

bus::Demander::Want BusSession::want(const std::string& board, const std::string& service, double hz) {
    return state_->caller.want(board, service.empty() ? "*" : service, hz);
}

BusSession::Demand BusSession::demand(const std::string& board, const std::string& service, double hz) {
    const bool pattern = board.find_first_of("*?") != std::string::npos;
    return {
        subscribe(state_->environment.topics.description(pattern ? "+" : board), [](const mqtt::Message&) {}),
        want(board, service, hz)};
}

BusSession::Mark BusSession::mark_retained() {
    return state_->caller.mark_retained();
}

void BusSession::wait_retained(const std::function<bool()>& enough, Duration patience) {
    const auto began = Clock::now();
    const auto mark = mark_retained();
    const auto over = [&] {
        const auto last = std::max(state_->caller.retained_at(), mark.passed_at().value_or(began));
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
        state_->caller.tick(Clock::now());
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
        state_->caller.tick(Clock::now());
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
    return state_->caller.access().why_lost().has_value();
}

Outcome<void> BusSession::heard_all() const {
    if (stopped()) return interrupted();
    if (lost()) return tl::unexpected(unanswered({}));
    return {};
}

Failure BusSession::unanswered(std::string text) const {
    const bool wants_text = !text.empty();
    const auto reply = state_->caller.silence(std::move(text), state_->environment.timeout);
    if (reply.reason == bus::kTimeoutConnection) return {program::kExitBroker, reply.error};
    return {program::kExitNoAnswer, wants_text ? reply.error : std::string()};
}

bool BusSession::denied(const std::string& topic) const {
    return state_->denied.contains(topic);
}

void BusSession::tell_refused_subscriptions() {
    state_->tells_refusals = true;
}

}  // namespace asip::cli
