#include "cli/bus_session.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

#include "asip/model/json.hpp"
#include "asip/program/stop_signal.hpp"
#include "asip/random.hpp"

namespace asip::cli {

using namespace std::chrono_literals;

struct BusSession::State {
    explicit State(const Context& its_context)
        : context(its_context),
          timeout(context.timeout),
          name(random_hex(system_random(), 12)),
          reply_topic(context.topics.reply(context.mqtt.user, name)),
          signal(io, [this](int) { stopped = true; }),
          client(io, context.mqtt, handlers()) {
        for (const auto& broker : context.mqtt.brokers)
            brokers.insert(broker.describe());
    }

    mqtt::Client::Handlers handlers() {
        mqtt::Client::Handlers result;
        result.on_connected = [this](const mqtt::Connected&) { connected_again(); };
        result.on_disconnected = [this](const mqtt::ConnectionFailure& why) {
            if (connection_changed) connection_changed(false, why.text);
        };
        result.on_connect_failed = [this](const mqtt::ConnectionFailure& why) {
            failed[why.broker.describe()] = why;
        };
        result.on_message = [this](const mqtt::Message& message) { dispatch(message); };
        result.on_published = [this](const std::string&) { ++acknowledged; };
        result.on_subscribe_refused = [this](const std::string& filter, const std::string& reason) {
            refused = filter + ": " + reason;
        };
        return result;
    }

    void connected_again() {
        const bool first = !std::exchange(was_connected, true);
        if (!first && connection_changed) connection_changed(true, {});
    }

    /// Each broker of the list is out of reach or has refused: waiting for another attempt is no use.
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
        if (message.topic == reply_topic) {
            answer(message);
            return;
        }
        std::vector<OnMessage> called;  // a copy: handlers subscribe and unsubscribe
        for (const auto& [filter, handler] : subscriptions) {
            if (topic_matches(filter, message.topic)) called.push_back(handler);
        }
        for (const auto& handler : called)
            handler(message);
    }

    void answer(const mqtt::Message& message) {
        auto id = message.correlation;
        if (id.empty()) {
            const auto document =
                model::parse_json(message.payload, {.max_bytes = 64U << 20U, .max_depth = 64});
            if (document && document->is_object()) {
                if (const auto found = document->find("id"); found != document->end() && found->is_string())
                    id = *found;
            }
        }
        for (const auto& [number, handler] : requests) {
            if (request_id(number) != id) continue;
            const auto kept = handler;
            kept(message);
            return;
        }
    }

    // Whoever answers tells repeated requests by it: never the same from two processes.
    std::string request_id(std::size_t number) const { return name + "-" + std::to_string(number); }

    const Context& context;
    std::chrono::milliseconds timeout;
    std::string name;
    std::string reply_topic;
    boost::asio::io_context io{1};
    bool stopped = false;
    bool was_connected = false;
    std::size_t acknowledged = 0;
    std::set<std::string> brokers;
    std::map<std::string, mqtt::ConnectionFailure> failed;  // the last failure of each broker
    std::string refused;
    std::function<void(bool, const std::string&)> connection_changed;
    std::vector<std::pair<std::string, OnMessage>> subscriptions;
    std::map<std::size_t, OnMessage> requests;
    std::size_t next_request = 1;
    bool started = false;
    program::StopSignal signal;
    mqtt::Client client;
};

BusSession::BusSession(const Context& context) : state_(std::make_unique<State>(context)) {
    state_->client.subscribe(state_->reply_topic, {.qos = 0, .no_local = false, .retained = false});
}

BusSession::~BusSession() {
    if (!state_->was_connected) return;
    bool done = false;
    state_->client.stop(300ms, [&done] { done = true; });
    while (!done && state_->io.run_one_for(400ms) != 0) {
    }
}

void BusSession::subscribe(const std::string& filter, OnMessage on_message, mqtt::SubscribeOptions options) {
    state_->subscriptions.emplace_back(filter, std::move(on_message));
    state_->client.subscribe(filter, options);
}

void BusSession::unsubscribe(const std::string& filter) {
    std::erase_if(state_->subscriptions, [&](const auto& one) { return one.first == filter; });
    state_->client.unsubscribe(filter);
}

Outcome<void> BusSession::connect() {
    if (!std::exchange(state_->started, true)) state_->client.start();
    run_until([this] { return state_->was_connected || state_->no_broker_left(); },
              Clock::now() + state_->timeout);
    if (state_->was_connected) return {};
    if (state_->stopped) return failure(program::kExitFailure, "interrupted");
    if (!state_->failed.empty()) return failure(program::kExitBroker, state_->why_not_connected());
    return failure(program::kExitBroker,
                   "the broker does not answer; is --broker right? Try: asipctl doctor");
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
    state_->client.publish(std::move(message), mqtt::Priority::kReply);
}

std::size_t BusSession::ask(const std::string& topic, const std::string& payload, OnMessage on_reply,
                            int qos) {
    const auto id = state_->next_request++;
    state_->requests.emplace(id, std::move(on_reply));
    mqtt::Message message;
    message.topic = topic;
    message.payload = payload;
    message.qos = qos;
    if (v5()) {
        message.response_topic = state_->reply_topic;
        message.correlation = state_->request_id(id);
    } else {
        message.payload = with_reply_members(payload, state_->reply_topic, state_->request_id(id));
    }
    state_->client.publish(std::move(message), mqtt::Priority::kReply);
    return id;
}

void BusSession::forget_request(std::size_t id) {
    state_->requests.erase(id);
}

void BusSession::after_retained(std::function<void()> passed) {
    const auto topic = state_->reply_topic + "/mark" + std::to_string(state_->next_request++);
    subscribe(topic, [this, topic, passed = std::move(passed)](const mqtt::Message&) {
        const auto kept = passed;
        unsubscribe(topic);
        kept();
    });
    publish(topic, "mark");
}

bool BusSession::run_until(const std::function<bool()>& done, Time deadline) {
    while (!done()) {
        if (state_->context.output_ended()) state_->stopped = true;
        if (state_->stopped) return false;
        const auto left = deadline - Clock::now();
        if (left <= Duration::zero()) return false;
        // `done` may wait for time to pass, too.
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

const std::string& BusSession::subscription_refused() const {
    return state_->refused;
}

bool topic_matches(std::string_view filter, std::string_view topic) {
    while (true) {
        if (filter == "#") return true;
        const auto filter_end = std::min(filter.find('/'), filter.size());
        const auto topic_end = std::min(topic.find('/'), topic.size());
        const auto level = filter.substr(0, filter_end);
        if (level != "+" && level != topic.substr(0, topic_end)) return false;
        const bool filter_more = filter_end < filter.size();
        const bool topic_more = topic_end < topic.size();
        if (!filter_more || !topic_more)
            return filter_more == topic_more || filter.substr(filter_end) == "/#";
        filter.remove_prefix(filter_end + 1);
        topic.remove_prefix(topic_end + 1);
    }
}

std::string with_reply_members(const std::string& payload, const std::string& reply_to,
                               const std::string& id) {
    auto document = model::parse_json(payload, {.max_bytes = 1U << 20U, .max_depth = 32});
    nlohmann::json object = nlohmann::json::object();
    if (document && document->is_object()) {
        object = std::move(*document);
    } else {
        object["raw"] = payload;
    }
    object["reply_to"] = reply_to;
    object["id"] = id;
    return model::dump_json(object);
}

}  // namespace asip::cli
