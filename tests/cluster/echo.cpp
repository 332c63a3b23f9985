// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/echo.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "tests/cluster/commander.hpp"

namespace cluster {

namespace {

constexpr auto kBetweenMessages = std::chrono::milliseconds(100);
/// A node that delivers nothing to a connection for this long may do so to a new one.
constexpr Millis kPatience = 6'000;
const std::string kTopics = "cluster-test/echo/";
const std::string kRetained = "cluster-test/retained/";
const std::string kOwn = "cluster-test/own/";

}  // namespace

Echo::Echo(boost::asio::io_context& io, asip::mqtt::Options options, std::size_t number, std::size_t count)
    : io_(io), options_(std::move(options)), topic_(std::to_string(number)), heard_(count), timer_(io) {}

void Echo::start() {
    connect();
    send();
}

void Echo::connect() {
    auto options = options_;
    options.client_id += "-" + std::to_string(now());
    asip::mqtt::Client::Handlers handlers;
    handlers.on_connected = [this](const asip::mqtt::Connected&) { delivered_ = now(); };
    handlers.on_message = [this](const asip::mqtt::Message& message) { received(message); };
    client_ = std::make_unique<asip::mqtt::Client>(io_, std::move(options), std::move(handlers));
    client_->subscribe(kTopics + "+");
    if (!own_.empty()) client_->subscribe(own_);
    client_->start();
}

void Echo::look_anew() {
    since_ = now();
    std::fill(heard_.begin(), heard_.end(), std::nullopt);
    if (!own_.empty()) client_->unsubscribe(own_);
    own_ = kOwn + topic_ + "/" + std::to_string(since_);
    client_->subscribe(own_);
}

void Echo::received(const asip::mqtt::Message& message) {
    const bool own = message.topic.starts_with(kOwn);
    const auto number =
        std::strtoull(own ? topic_.c_str() : message.topic.c_str() + kTopics.size(), nullptr, 10);
    if (own || std::to_string(number) == topic_) delivered_ = now();
    if (!own && std::to_string(number) == topic_) return;
    const bool counts = std::strtoll(message.payload.c_str(), nullptr, 10) >= since_;
    if (counts && number < heard_.size() && !heard_[number]) heard_[number] = now();
}

std::optional<Millis> Echo::heard() const {
    if (!std::all_of(heard_.begin(), heard_.end(), [](const auto& each) { return each.has_value(); }))
        return std::nullopt;
    return *std::max_element(heard_.begin(), heard_.end());
}

void Echo::send() {
    timer_.expires_after(kBetweenMessages);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error) return;
        const auto payload = std::to_string(now());
        if (client_->connected() && now() - delivered_ > kPatience) connect();
        if (client_->connected() && !heard())
            client_->publish({.topic = kRetained + topic_, .payload = payload, .retain = true});
        if (client_->connected()) client_->publish({.topic = kTopics + topic_, .payload = payload});
        if (client_->connected() && !own_.empty()) client_->publish({.topic = own_, .payload = payload});
        send();
    });
}

}  // namespace cluster
