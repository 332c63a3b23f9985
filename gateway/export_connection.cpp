// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <utility>

#include "asip/mqtt/failure.hpp"
#include "asip/program/broker_log.hpp"
#include "asip/program/log.hpp"
#include "gateway/running_exports.hpp"

namespace asip::gateway {
namespace {

namespace log = program::log;

constexpr std::size_t kMaxQueuedMessages = 100'000;
constexpr std::size_t kMaxQueuedBytes = std::size_t{32} << 20;
constexpr std::size_t kRoomMessages = 5'000;  // what waits beyond delays what is newer
constexpr std::size_t kRoomBytes = std::size_t{1} << 20;
constexpr std::size_t kLittle = 20;  // messages that wait
constexpr Duration kConnectionEnd = std::chrono::seconds(5);

}  // namespace

void ExportConnection::connect(exports::Export& of) {
    auto options = options_;
    options.client_id += "-" + std::string(of.by());
    options.will = of.will();
    options.max_queued_messages = kMaxQueuedMessages;
    options.max_queued_bytes = kMaxQueuedBytes;
    mqtt::Client::Handlers handlers;
    handlers.on_connected = [this, &of](const mqtt::Connected&) {
        of.own_connected();
        if (auto will = of.will(); client_ && will) client_->set_will(std::move(*will));
    };
    handlers.on_subscribed = [&of] { of.own_subscribed(Clock::now()); };
    handlers.on_disconnected = [&of](const mqtt::ConnectionFailure& failure) {
        of.own_disconnected();
        log::warning("the connection for exports is lost", {{"why", failure.text}});
    };
    handlers.on_message = [&of](const mqtt::Message& message) { of.own_message(message, Clock::now()); };
    handlers.on_published = [this, &of](const std::string&) { tell_soon(of); };
    handlers.on_publish_denied = [user = options.user](const std::string& topic, const std::string& reason) {
        log::warning(mqtt::denied_text(user, topic, reason, "gateway"));
    };
    handlers.on_subscribe_refused = program::BrokerLog::subscribe_refused;
    client_ = std::make_unique<mqtt::Client>(io_, std::move(options), std::move(handlers));
    mqtt::SubscribeOptions subscription;
    subscription.qos = 1;
    for (auto& filter : of.own_subscriptions())
        client_->subscribe(std::move(filter), subscription);
    client_->start();
}

void ExportConnection::tell_soon(exports::Export& of) {
    if (!client_ || client_->counters().queued >= kLittle || std::exchange(sent_, true)) return;
    // Behind all acknowledgements that are there, each of which lets a message go.
    boost::asio::post(io_, [this, &of] {
        sent_ = false;
        of.sent(Clock::now());
    });
}

exports::Export::Port ExportConnection::port(std::function<exports::Export&()> of) {
    exports::Export::Port port;
    port.connect = [this, of] { connect(of()); };
    port.again = [this, of] { tell_soon(of()); };
    // It may be in the middle of a handler of that client, which must not end it.
    port.disconnect = [this] { stop(kConnectionEnd, [] {}); };
    port.publish = [this, of = std::move(of)](mqtt::Message message) {
        if (!client_) return;
        const bool acknowledged = message.qos > 0;
        client_->publish(std::move(message), mqtt::Priority::kAnnouncement);
        if (!acknowledged) tell_soon(of());
    };
    port.has_room = [this] {
        if (!client_) return false;
        const auto counters = client_->counters();
        return counters.queued < kRoomMessages && counters.queued_bytes < kRoomBytes;
    };
    port.discard = [this] {
        if (client_) client_->discard_queued(mqtt::Priority::kAnnouncement);
    };
    port.subscribe = [this](const std::string& filter) {
        mqtt::SubscribeOptions options;
        options.qos = 1;
        if (client_) client_->subscribe(filter, options);
    };
    port.watch = [this](const std::string& filter) {
        if (client_) client_->subscribe(filter, {.qos = 1, .no_local = true, .retained = false});
    };
    port.unsubscribe = [this](const std::string& filter) {
        if (client_) client_->unsubscribe(filter);
    };
    return port;
}

void ExportConnection::tidy() {
    std::erase_if(ending_, [](const auto& each) { return each->done; });
}

void ExportConnection::stop(Duration limit, std::function<void()> done) {
    if (client_) {
        auto ending = std::make_shared<Ending>();
        ending->client = std::move(client_);
        ending_.push_back(ending);
        ending->client->stop(limit, [raw = ending.get()] {
            raw->done = true;
            if (raw->then) raw->then();
        });
    }
    // One that was ended before may still be sending.
    const auto left = std::make_shared<std::ptrdiff_t>(
        std::count_if(ending_.begin(), ending_.end(), [](const auto& each) { return !each->done; }));
    if (*left == 0) return done();
    for (const auto& each : ending_) {
        if (each->done) continue;
        each->then = [before = std::move(each->then), left, done] {
            if (before) before();
            if (--*left == 0) done();
        };
    }
}

}  // namespace asip::gateway
