// SPDX-License-Identifier: Apache-2.0
#include "asip/client/bus_transport.hpp"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <nlohmann/json.hpp>

#include "asip/bus/request/answer_words.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/json.hpp"
#include "asip/mqtt/failure.hpp"
#include "asip/random.hpp"

namespace asip::client {
namespace {

using Json = nlohmann::json;

constexpr PendingCalls::Id kOpening = 0;
// What is set in more of them is not kept.
constexpr std::size_t kMaxServices = 256;
// Beyond a command's deadline, for the way of its answer.
constexpr auto kAnswerTime = std::chrono::milliseconds(500);
// Closing tells boards that nothing is wanted of them any more.
constexpr auto kLeaveTime = std::chrono::milliseconds(500);

Expected<mqtt::Options> mqtt_options(const Address& address, const Options& options, std::string client_id) {
    mqtt::Options mqtt;
    mqtt.brokers = {mqtt::BrokerAddress{address.host, address.port, address.tls}};
    mqtt.client_id = std::move(client_id);
    mqtt.user = options.user.empty() ? address.user : options.user;
    if (!options.password_file.empty()) {
        auto password = mqtt::read_password_file(options.password_file);
        if (!password) return fail(password.error());
        mqtt.password = std::move(*password);
    }
    mqtt.ca_file = options.ca;
    mqtt.cert_file = options.certificate;
    mqtt.key_file = options.key;
    return mqtt;
}

Error error_of(const bus::Reply& reply) {
    switch (reply.status) {
        case bus::Reply::Status::kError:
            return {Error::Kind::kBoard, reply.code, bus::why_of(reply)};
        case bus::Reply::Status::kRefused:
            if (reply.reason == bus::kRefusedInvalid) {
                return {Error::Kind::kInvalid, 0, bus::why_of(reply)};
            }
            if (reply.reason == bus::kRefusedBoardNotThere) {
                return {Error::Kind::kUnreachable, 0, bus::why_of(reply)};
            }
            return {Error::Kind::kRefused, 0, bus::why_of(reply)};
        default:
            return {Error::Kind::kTimeout, 0, bus::why_of(reply)};
    }
}

/// Publishes `messages`, lets the client disconnect, and ends it, whatever becomes of the broker. It lives in
/// the loop alone: with a loop that ends before, it ends.
void leave(boost::asio::io_context& io, std::shared_ptr<mqtt::Client> client,
           std::vector<mqtt::Message> messages) {
    for (auto& message : messages)
        client->publish(std::move(message), mqtt::Priority::kReply);
    const auto limit = std::make_shared<boost::asio::steady_timer>(io, 2 * kLeaveTime);
    client->stop(kLeaveTime, [weak = std::weak_ptr(limit)] {
        if (const auto timer = weak.lock()) timer->cancel();
    });
    limit->async_wait([limit, client = std::move(client)](boost::system::error_code) {});
}

}  // namespace

BusTransport::BusTransport(boost::asio::io_context& io, Address address, Options options)
    : io_(io),
      address_(std::move(address)),
      options_(std::move(options)),
      topics_(options_.topic_root),
      demand_timer_(io),
      calls_(io.get_executor()),
      view_(topics_),
      lease_timer_(io) {}

BusTransport::~BusTransport() {
    close();
}

Awaitable<void> BusTransport::open(Listener& listener) {
    listener_ = &listener;
    if (const auto made = make_client(); !made) {
        co_return failure(Error::Kind::kInvalid, made.error());
    }
    calls_.begin(kOpening);
    client_->start();
    const auto done = co_await calls_.wait(kOpening, options_.open_timeout, "");
    if (!done) {
        const bool late = done.error().kind == Error::Kind::kTimeout;
        co_return failure(late ? Error::Kind::kUnreachable : done.error().kind,
                          late ? why_not_there() : done.error().text);
    }
    co_return Result<void>();
}

Expected<void> BusTransport::make_client() {
    const std::string client_id = "asip-client-" + random_hex(system_random(), 16);
    auto mqtt = mqtt_options(address_, options_, client_id);
    if (!mqtt) return fail(mqtt.error());
    user_ = mqtt->user;
    requester_.emplace(client_id, bus::ReplyTopics(topics_, mqtt->user, client_id));
    demander_.emplace(topics_, mqtt->user, client_id, system_random());
    mqtt::Client::Handlers handlers;
    // A callback may drop the last Board, and this with it, while the client has more to deliver.
    handlers.on_message = while_alive([this](const mqtt::Message& message) { take(message); });
    handlers.on_connected = while_alive([this](const mqtt::Connected&) { connected(); });
    handlers.on_connect_failed = while_alive([this](const mqtt::ConnectionFailure& why) { failed(why); });
    handlers.on_disconnected = while_alive([this](const mqtt::ConnectionFailure& why) { failed(why); });
    handlers.on_publish_denied = [alive = std::weak_ptr<bool>(alive_), this](const std::string& topic,
                                                                             const std::string& reason) {
        if (alive.lock()) denied(topic, reason);
    };
    client_ = std::make_unique<mqtt::Client>(io_, std::move(*mqtt), std::move(handlers));
    client_->subscribe(requester_->replies().filter(), {.qos = 1});
    client_->subscribe(topics_.state(address_.board), {.qos = 1});
    client_->subscribe(topics_.description(address_.board), {.qos = 1});
    client_->subscribe(topics_.service_out(address_.board, "+"),
                       {.qos = 0, .no_local = false, .retained = false});
    client_->subscribe(topics_.service_set(address_.board, "+"), {.qos = 1});
    return {};
}

std::string BusTransport::why_not_there() const {
    if (!failure_.empty()) {
        return failure_;
    }
    const std::string where = address_.host + ":" + std::to_string(address_.port);
    const auto known = view_.board(address_.board, catalogue::instant_now());
    if (!known) {
        return "no board " + address_.board + " on the broker " + where +
               "; does its agent run? `asipctl list` shows the boards there are";
    }
    const auto why = model::words_of(model::state_reason_from_text(known->reason));
    return "board " + address_.board + " on the broker " + where + " is " + known->state +
           (why.empty() ? "" : ": " + std::string(why)) +
           (description() != nullptr ? "" : " but has not described itself");
}

Awaitable<Json> BusTransport::command(std::string service, Json command) {
    if (const auto* described = description();
        described == nullptr || described->service(service) == nullptr) {
        co_return failure(Error::Kind::kInvalid,
                          "board " + address_.board + " has no service \"" + service + "\"");
    }
    if (!command.is_object()) {
        co_return failure(Error::Kind::kInvalid, "a command is a JSON object, {\"write\":[0,90]}");
    }
    co_return co_await request(topics_.service_in(address_.board, service), std::move(command));
}

Awaitable<void> BusTransport::raw(std::string line) {
    Json payload = Json::object();
    payload["raw"] = std::move(line);
    const auto done = co_await request(topics_.board_in(address_.board), std::move(payload));
    co_return done ? Result<void>() : Result<void>(Unexpected<Error>(done.error()));
}

/// At most once: a command that is sent again after the connection was lost could arrive when it is
/// no longer wanted. Its answer shows that it arrived.
Awaitable<Json> BusTransport::request(std::string topic, Json payload) {
    const PendingCalls::Id id = next_id_++;
    mqtt::Message message;
    message.topic = std::move(topic);
    const auto deadline = std::clamp(options_.command_timeout, bus::kMinDeadline, bus::kMaxDeadline);
    payload["deadline_ms"] = deadline.count();
    message.payload = model::dump_json(payload);
    // What reaches the broker while the agent is away is not delivered when it is no longer wanted.
    message.expire_after(deadline);
    const auto asked = requester_->ask(message, client_->v5(),
                                       [this, id](const mqtt::Message& answer) { take_reply(id, answer); });
    calls_.begin(id);
    const auto unanswered = "neither the board nor its agent answered; the agent may be gone" +
                            mqtt::unanswered_text(user_, message.topic) +
                            std::string(bus::kMayHaveBeenExecuted);
    const auto asked_topics = asked_;
    asked_topics->emplace(id, message.topic);
    if (client_->publish(std::move(message), mqtt::Priority::kReply) == mqtt::PublishResult::kRefused) {
        calls_.finish(
            id, failure(Error::Kind::kRefused, "too many commands wait for the broker: it is slow, or away"));
    }
    auto outcome = co_await calls_.wait(id, deadline + kAnswerTime, unanswered);
    asked_topics->erase(id);  // this may be gone
    co_return outcome;
}

std::vector<ServiceInfo> BusTransport::services() const {
    std::vector<ServiceInfo> infos;
    if (const auto* described = description()) {
        for (const auto& service : described->services) {
            infos.push_back(
                {service.name, service.id, service.title, described->labels.service(service.name)});
        }
    }
    return infos;
}

std::map<std::string, std::string> BusTransport::labels() const {
    const auto* described = description();
    return described != nullptr ? described->labels.labels : std::map<std::string, std::string>();
}

std::shared_ptr<void> BusTransport::demand(const std::string& service, double hz) {
    static_assert(kUsualHz == bus::kUsualHz);
    if (closed_ || !demander_) {
        return nullptr;
    }
    auto want = demander_->want(address_.board, service, hz);
    publish_demands();
    const auto end = [this, want, alive = std::weak_ptr<bool>(alive_)](void*) mutable {
        want.reset();
        if (alive.lock()) publish_demands();
    };
    return {nullptr, end};
}

/// Those that are due, now and later.
void BusTransport::publish_demands() {
    for (auto& message : demander_->due(Clock::now())) {
        client_->publish(std::move(message));
    }
    const auto next = demander_->next_deadline();
    if (!next) {
        demand_timer_.cancel();
        return;
    }
    demand_timer_.expires_at(*next);
    demand_timer_.async_wait([this, alive = std::weak_ptr<bool>(alive_)](boost::system::error_code error) {
        if (!error && alive.lock()) publish_demands();
    });
}

void BusTransport::close() {
    if (closed_) {
        return;
    }
    closed_ = true;
    demand_timer_.cancel();
    lease_timer_.cancel();
    alive_.reset();
    calls_.finish_all({Error::Kind::kClosed, 0, "the board was closed"});
    if (!client_) {
        return;
    }
    std::shared_ptr<mqtt::Client> client = std::move(client_);
    if (auto nothing_wanted = demander_->leave(); !nothing_wanted.empty()) {
        leave(io_, std::move(client), std::move(nothing_wanted));
    } else {
        // This may be called from one of the client's handlers, which must not destroy it.
        boost::asio::post(io_, [client = std::move(client)] {});
    }
}

void BusTransport::take(const mqtt::Message& message) {
    if (requester_->take(message)) {
        return;
    }
    const auto topic = topics_.parse(message.topic);
    if (!topic || topic->board != address_.board) {
        return;
    }
    if (topic->kind == bus::TopicKind::kState) {
        told_ = true;
        view_.apply(message, Clock::now());
        look_again();
    } else if (topic->kind == bus::TopicKind::kDescription) {
        told_ = told_ || !message.retain;
        view_.apply(message, Clock::now());
        demander_->take(message, Clock::now());
        publish_demands();
        look_again();
    } else if (topic->kind == bus::TopicKind::kServiceSet) {
        take_set(topic->service, message);
    } else if (topic->kind == bus::TopicKind::kServiceOut && !message.retain) {
        take_event(topic->service, message);
    }
}

void BusTransport::take_reply(PendingCalls::Id id, const mqtt::Message& message) {
    const auto reply = bus::parse_reply(message.payload);
    if (!reply) {
        return;
    }
    if (!reply->succeeded()) {
        calls_.finish(id, Unexpected<Error>(error_of(*reply)));
        return;
    }
    auto answer = reply->answer.empty() ? Expected<Json>(Json()) : model::parse_json(reply->answer);
    calls_.finish(id, answer ? std::move(*answer) : Json());
}

nlohmann::json BusTransport::was_set(const std::string& service) const {
    const auto known = set_.find(service);
    return known == set_.end() ? Json() : known->second;
}

void BusTransport::take_set(std::string_view service, const mqtt::Message& message) {
    auto set = message.payload.empty() ? Expected<Json>(Json()) : model::parse_json(message.payload);
    const std::string name(service);
    if (!set || (set_.size() >= kMaxServices && !set_.contains(name)) || was_set(name) == *set) {
        return;
    }
    set_[name] = std::move(*set);
    listener_->on_set(name);
}

void BusTransport::take_event(std::string_view service, const mqtt::Message& message) {
    const auto event = model::parse_json(message.payload);
    if (event && there_) {
        listener_->on_event(std::string(service), *event);
    }
}

/// Whether the board is there now, and what follows if that changed.
void BusTransport::look_again() {
    const auto known = view_.board(address_.board, catalogue::instant_now());
    const bool there = client_->connected() && known && known->state == "online" && told_ &&
                       !known->reported.empty() && description() != nullptr;
    if (there) {
        calls_.finish(kOpening, Json());
    }
    if (const auto next = view_.next_expiry()) {
        lease_timer_.expires_at(*next);
        lease_timer_.async_wait([this, alive = std::weak_ptr<bool>(alive_)](boost::system::error_code error) {
            if (!error && alive.lock()) look_again();
        });
    }
    if (there != there_) {
        there_ = there;
        if (!there) {
            calls_.finish_all(
                {Error::Kind::kUnreachable, 0, why_not_there() + std::string(bus::kMayHaveBeenExecuted)});
        }
        listener_->on_presence(there);
    }
}

void BusTransport::connected() {
    failure_.clear();
    view_.connected(Clock::now());
    mqtt::Message probe;  // an agent whose retained description the broker lost announces again
    probe.topic = topics_.probe();
    probe.payload = address_.board;
    client_->publish(std::move(probe));
    demander_->connected(Clock::now());
    publish_demands();
}

void BusTransport::denied(const std::string& topic, const std::string& reason) {
    const auto asked = *asked_;
    for (const auto& [id, where] : asked) {
        if (where == topic)
            calls_.finish(id, failure(Error::Kind::kRefused, mqtt::denied_text(user_, topic, reason)));
    }
}

void BusTransport::failed(const mqtt::ConnectionFailure& why) {
    demander_->disconnected();
    publish_demands();
    const bool cut_off = why.after_sending != 0 && !asked_->empty();
    failure_ = cut_off ? mqtt::cut_off_text(user_, asked_->rbegin()->second) : why.text;
    if (why.hopeless) {
        calls_.finish(kOpening, failure(Error::Kind::kUnreachable, why.text));
    }
    view_.disconnected();
    set_.clear();  // it comes again with the next connection, where it still holds
    told_ = false;
    if (there_) {
        look_again();
    }
}

}  // namespace asip::client
