// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <functional>
#include <string>
#include <utility>

#include "asip/caller/caller.hpp"

namespace asip::load {

/// A connection of its own that calls boards and registries, as asipctl, the library and the gateway do.
struct Calling {
    using OnMessage = std::function<void(const mqtt::Message&)>;
    /// `name`: behind the client id of `options`. `other`: what is no answer.
    Calling(boost::asio::io_context& io, mqtt::Options options, const bus::Topics& topics,
            const std::string& name, OnMessage other = {})
        : id((options.client_id += name)),
          client(io, options, handlers(std::move(other))),
          caller({.topics = topics, .user = options.user, .name = id}, system_random(),
                 caller::port_of(client)) {}

    std::string id;
    mqtt::Client client;
    caller::Caller caller;

  private:
    mqtt::Client::Handlers handlers(OnMessage other) {
        mqtt::Client::Handlers result;
        result.on_connected = [this](const mqtt::Connected&) { caller.connected(Clock::now()); };
        result.on_disconnected = [this](const mqtt::ConnectionFailure& why) {
            caller.disconnected(why, Clock::now());
        };
        result.on_publish_denied = [this](const std::string& topic, const std::string& reason) {
            caller.denied(topic, reason);
        };
        result.on_message = [this, other = std::move(other)](const mqtt::Message& message) {
            if (!caller.message(message, Clock::now()) && other) other(message);
        };
        return result;
    }
};

}  // namespace asip::load
