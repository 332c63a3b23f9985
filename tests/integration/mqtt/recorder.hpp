// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "asip/mqtt/client.hpp"
#include "tests/support/loop.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {

/// A client under test and everything it reported.
struct Recorder {
    explicit Recorder(mqtt::Options options) {
        mqtt::Client::Handlers handlers;
        handlers.on_connected = [this](const mqtt::Connected& c) {
            connects.push_back(c);
            if (at_connect) at_connect();
        };
        handlers.on_disconnected = [this](const mqtt::ConnectionFailure& f) { losses.push_back(f); };
        handlers.on_connect_failed = [this](const mqtt::ConnectionFailure& f) { failures.push_back(f); };
        handlers.on_message = [this](const mqtt::Message& m) {
            messages.push_back(m);
            if (at_message) at_message(m);
        };
        handlers.on_published = [this](const std::string& topic) { published.push_back(topic); };
        handlers.on_publish_denied = [this](const std::string& topic, const std::string&) {
            denied.push_back(topic);
        };
        handlers.on_subscribed = [this] { ++subscribed_calls; };
        client = std::make_unique<mqtt::Client>(io, std::move(options), std::move(handlers));
    }

    bool connect() {
        client->start();
        return until([this] { return client->connected(); });
    }
    template <class Condition>
    bool until(Condition condition, std::chrono::milliseconds limit = kDeadline) {
        return run_until(io, condition, limit);
    }
    bool received(const std::string& topic, const std::string& payload) {
        return until([&] {
            for (const auto& message : messages)
                if (message.topic == topic && message.payload == payload) return true;
            return false;
        });
    }

    boost::asio::io_context io;
    std::vector<mqtt::Connected> connects;
    std::vector<mqtt::ConnectionFailure> losses;
    std::vector<mqtt::ConnectionFailure> failures;
    std::vector<mqtt::Message> messages;
    std::vector<std::string> published;
    std::vector<std::string> denied;
    int subscribed_calls = 0;
    std::function<void()> at_connect;
    std::function<void(const mqtt::Message&)> at_message;
    std::unique_ptr<mqtt::Client> client;
};

inline mqtt::Options options_for(const MosquittoBroker& broker) {
    mqtt::Options options;
    options.brokers = {*mqtt::parse_broker(broker.url())};
    return options;
}

inline mqtt::Message make_message(std::string topic, std::string payload, int qos = 0, bool retain = false) {
    return mqtt::Message{
        .topic = std::move(topic), .payload = std::move(payload), .qos = qos, .retain = retain};
}

}  // namespace asip::test
