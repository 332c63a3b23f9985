// SPDX-License-Identifier: Apache-2.0
#include "asip/client/bus_transport.hpp"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "asip/bus/request/reply.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/caller/caller.hpp"
#include "asip/model/json.hpp"
#include "asip/mqtt/failure.hpp"
#include "asip/property/documents.hpp"
#include "asip/random.hpp"

namespace asip::client {
namespace {

using Json = nlohmann::json;

constexpr PendingCalls::Id kOpening = 0;
// The Caller ends each call in time: no other limit is needed.
constexpr auto kForever = std::chrono::hours(24);
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
    using Kind = Error::Kind;
    const auto& reason = reply.reason;
    auto kind = reason == bus::kTimeoutConnection ? Kind::kUnreachable : Kind::kTimeout;
    if (reply.status == bus::Reply::Status::kRefused)
        kind = reason == bus::kRefusedInvalid         ? Kind::kInvalid
               : reason == bus::kRefusedBoardNotThere ? Kind::kUnreachable
                                                      : Kind::kRefused;
    if (reply.status == bus::Reply::Status::kError) kind = Kind::kBoard;
    return {kind, reply.code, bus::why_of(reply)};
}

/// Lets the client say what it has to say, disconnect, and end, whatever becomes of the broker. It lives in
/// the loop alone: with a loop that ends before, it ends.
void leave(boost::asio::io_context& io, std::shared_ptr<mqtt::Client> client) {
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
      timer_(io),
      calls_(io.get_executor()) {}

BusTransport::~BusTransport() {
    close();
}

Awaitable<void> BusTransport::open(Listener& listener) {
    listener_ = &listener;
    if (const auto made = make_client(); !made) co_return failure(Error::Kind::kInvalid, made.error());
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
    mqtt::Client::Handlers handlers;
    // A callback may drop the last Board, and this with it, while the client has more to deliver.
    handlers.on_message = while_alive([this](const mqtt::Message& message) { take(message); });
    handlers.on_connected = while_alive([this](const mqtt::Connected&) { connected(); });
    handlers.on_connect_failed = while_alive([this](const mqtt::ConnectionFailure& why) { failed(why); });
    handlers.on_disconnected = while_alive([this](const mqtt::ConnectionFailure& why) { failed(why); });
    handlers.on_publish_denied = [alive = std::weak_ptr<bool>(alive_), this](const std::string& topic,
                                                                             const std::string& reason) {
        if (alive.lock()) caller_->denied(topic, reason);
    };
    client_ = std::make_unique<mqtt::Client>(io_, std::move(*mqtt), std::move(handlers));
    auto port = caller::port_of(*client_);
    port.changed = [this](const std::string& board, const mqtt::Message*) {
        changed_ = changed_ || board == address_.board;
    };
    caller_.emplace(caller::Caller::Options{topics_, user_, client_id}, system_random(), std::move(port));
    caller_->watch(address_.board);
    client_->subscribe(topics_.service_out(address_.board, "+"),
                       {.qos = 0, .no_local = false, .retained = false});
    client_->subscribe(topics_.values(address_.board), {.qos = 1});
    return {};
}

std::string BusTransport::why_not_there() {
    if (!failure_.empty()) return failure_;
    const std::string where = address_.host + ":" + std::to_string(address_.port);
    const auto known = caller_->boards().board(address_.board, catalogue::instant_now());
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
    if (!command.is_object())
        co_return failure(Error::Kind::kInvalid, "a command is a JSON object, {\"write\":[0,90]}");
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
    calls_.begin(id);
    const auto call = caller_->command(
        {.topic = std::move(topic),
         .payload = model::dump_json(payload),
         .deadline = std::clamp(options_.command_timeout, bus::kMinDeadline, bus::kMaxDeadline),
         .qos = 0,
         .silence = "neither the board nor its agent answered; the agent may be gone"},
        [this, id](const bus::Reply& reply) {
            if (!reply.succeeded()) return calls_.finish(id, Unexpected<Error>(error_of(reply)));
            auto answer = reply.answer.empty() ? Expected<Json>(Json()) : model::parse_json(reply.answer);
            calls_.finish(id, answer ? std::move(*answer) : Json());
        },
        Clock::now());
    wake_in_time();
    co_return co_await calls_.wait(id, kForever, {});
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
    if (closed_ || !caller_) return nullptr;
    auto want = caller_->want(address_.board, service, hz);
    wake_in_time();
    const auto end = [this, want, alive = std::weak_ptr<bool>(alive_)](void*) mutable {
        want.reset();
        if (alive.lock()) wake_in_time();
    };
    return {nullptr, end};
}

/// What is due now, and later.
void BusTransport::wake() {
    caller_->tick(Clock::now());
    wake_in_time();
    look_if_changed();
}

void BusTransport::wake_in_time() {
    const auto next = caller_->next_deadline();
    if (!next || (wakes_at_ && *wakes_at_ <= *next)) return;  // a timer that is early costs less than another
    wakes_at_ = next;
    timer_.expires_at(*next);
    timer_.async_wait([this, alive = std::weak_ptr<bool>(alive_)](boost::system::error_code error) {
        if (error || !alive.lock()) return;
        wakes_at_.reset();
        wake();
    });
}

void BusTransport::close() {
    if (closed_) return;
    closed_ = true;
    timer_.cancel();
    alive_.reset();
    calls_.finish_all({Error::Kind::kClosed, 0, "the board was closed"});
    if (!client_) return;
    const bool says_more = caller_->leave();
    std::shared_ptr<mqtt::Client> client = std::move(client_);
    if (says_more) {
        leave(io_, std::move(client));
    } else {
        // This may be called from one of the client's handlers, which must not destroy it.
        boost::asio::post(io_, [client = std::move(client)] {});
    }
}

void BusTransport::take(const mqtt::Message& message) {
    caller_->message(message, Clock::now());
    wake_in_time();
    const auto topic = topics_.parse(message.topic);
    if (!topic || topic->board != address_.board) return;
    if (changed_)
        look_if_changed();
    else if (topic->kind == bus::TopicKind::kValues)
        take_values(message);
    else if (topic->kind == bus::TopicKind::kServiceOut && !message.retain)
        take_event(topic->service, message);
}

nlohmann::json BusTransport::values(const std::string& service) const {
    auto result = Json::object();
    for (const auto& [id, value] : values_)
        if (property::service_of(id) == service) result[id] = value;
    return result;
}

void BusTransport::take_values(const mqtt::Message& message) {
    decltype(values_) now;
    if (!message.payload.empty()) {
        auto document = property::parse_values(message.payload);
        if (!document || document->head.board != address_.board) return;
        for (auto& [id, shown] : document->values)
            if (shown.how != property::How::kNone) now.emplace(id, std::move(shown.value));
    }
    std::set<std::string> changed;
    for (const auto& [id, value] : now)
        if (const auto before = values_.find(id); before == values_.end() || before->second != value)
            changed.emplace(property::service_of(id));
    for (const auto& [id, value] : values_)
        if (!now.contains(id)) changed.emplace(property::service_of(id));
    values_ = std::move(now);
    const std::weak_ptr<bool> alive(alive_);
    for (const auto& service : changed)
        if (alive.lock()) listener_->on_values(service);
}

void BusTransport::take_event(std::string_view service, const mqtt::Message& message) {
    const auto event = model::parse_json(message.payload);
    if (event && there_) listener_->on_event(std::string(service), *event);
}

void BusTransport::look_if_changed() {
    if (std::exchange(changed_, false)) look_again();
}

/// Whether the board is there now, and what follows if that changed. The listener may close this, and end it.
void BusTransport::look_again() {
    const auto known = caller_->boards().board(address_.board, catalogue::instant_now());
    const bool there = client_->connected() && known && known->state == "online" &&
                       caller_->heard_of(address_.board) && !known->reported.empty() &&
                       description() != nullptr;
    if (there) calls_.finish(kOpening, Json());
    if (there != there_) {
        there_ = there;
        if (!there) {
            auto lost = bus::Reply::timeout(bus::kTimeoutConnection);
            lost.error = why_not_there();
            caller_->end_all(lost);
        }
        listener_->on_presence(there);
    }
}

void BusTransport::connected() {
    failure_.clear();
    mqtt::Message probe;  // an agent whose retained description the broker lost announces again
    probe.topic = topics_.probe();
    probe.payload = address_.board;
    client_->publish(std::move(probe));
    caller_->connected(Clock::now());
    wake_in_time();
}

void BusTransport::failed(const mqtt::ConnectionFailure& why) {
    const auto waiting = caller_->waiting_topic();
    const bool cut_off = why.after_sending != 0 && !waiting.empty();
    caller_->disconnected(why, Clock::now());
    failure_ = cut_off ? mqtt::cut_off_text(user_, waiting) : why.text;
    if (why.hopeless) calls_.finish(kOpening, failure(Error::Kind::kUnreachable, why.text));
    values_.clear();  // it comes again with the next connection, where it still holds
    if (there_) look_again();
}

}  // namespace asip::client
