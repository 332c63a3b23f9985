// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "asip/caller/caller.hpp"

namespace asip::caller {

using namespace std::chrono_literals;
using nlohmann::json;

/// A program with a caller, whose connection, broker and boards the test plays, in simulated time.
class SimulatedProgram {
  public:
    SimulatedProgram() {
        Caller::Port port;
        port.publish = [this](mqtt::Message message) {
            if (room) sent.push_back(std::move(message));
            return room;
        };
        port.publish_first = [this](mqtt::Message message) {
            sent_first.push_back(std::move(message));
            return true;
        };
        port.subscribe = [this](const std::string& filter, mqtt::SubscribeOptions) {
            subscribed.push_back(filter);
        };
        port.unsubscribe = [this](const std::string& filter) { unsubscribed.push_back(filter); };
        port.v5 = [this] { return v5; };
        port.unacknowledged = [this] { return unacknowledged; };
        port.changed = [this](const std::string& board, const mqtt::Message*) { changed.push_back(board); };
        caller = std::make_unique<Caller>(
            Caller::Options{bus::Topics("asip"), "ann", "me"}, [] { return 0x5a5a5a5au; }, std::move(port));
    }

    void connect() { caller->connected(now); }
    void lose(const std::string& why = "the broker closed the connection", unsigned after_sending = 0) {
        mqtt::ConnectionFailure failure;
        failure.text = why;
        failure.after_sending = after_sending;
        caller->disconnected(failure, now);
    }
    /// Lets time pass, and wakes the caller exactly when it wants to be woken.
    void pass(Duration time) {
        const auto until = now + time;
        while (true) {
            const auto next = caller->next_deadline();
            if (!next || *next > until) break;
            now = std::max(now, *next);
            caller->tick(now);
        }
        now = until;
    }
    void receive(std::string topic, std::string payload, bool retain = false, std::string correlation = {}) {
        mqtt::Message message{.topic = std::move(topic),
                              .payload = std::move(payload),
                              .retain = retain,
                              .correlation = std::move(correlation)};
        caller->message(message, now);
    }
    /// As the agent that was asked.
    void answer(const mqtt::Message& request, json document, const std::string& clock = {}) {
        const auto members = json::parse(request.payload);
        document["id"] = members.at("id");
        if (!clock.empty()) document["clock"] = clock;
        receive(members.at("reply_to"), document.dump());
    }
    Caller::Call command(Command command) {
        return caller->command(
            std::move(command), [this](const bus::Reply& reply) { replies.push_back(reply); }, now);
    }
    Caller::Call write() { return command({.topic = "asip/uno1/servo/in", .payload = "W,0,90"}); }
    /// What was published on `topic` since the last call.
    std::vector<mqtt::Message> taken(const std::string& topic) {
        std::vector<mqtt::Message> result;
        for (auto& message : std::exchange(sent, {}))
            if (message.topic == topic) result.push_back(std::move(message));
        return result;
    }

    Time now{std::chrono::hours(1)};
    bool v5 = true;
    bool room = true;
    std::size_t unacknowledged = 0;
    std::vector<mqtt::Message> sent, sent_first;
    std::vector<std::string> subscribed, unsubscribed, changed;
    std::vector<bus::Reply> replies;
    std::unique_ptr<Caller> caller;
};

}  // namespace asip::caller
