// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "asip/program/log.hpp"
#include "clock.hpp"
#include "gateway/gateway.hpp"

namespace asip::gateway {

/// A gateway without sockets: requests and messages of the bus go in, answers and messages come out.
class ApiTest : public testing::Test {
  protected:
    struct Captured final : http::Responder {
        std::optional<http::Response> response;
        std::unique_ptr<http::Source> source;
        std::unique_ptr<http::Channel> channel;
        void respond(std::uint64_t, http::Response answer) override { response = std::move(answer); }
        void stream(std::uint64_t, http::Response head, std::unique_ptr<http::Source> made) override {
            response = std::move(head);
            source = std::move(made);
        }
        void upgrade(std::uint64_t, std::unique_ptr<http::Channel> made) override {
            response.emplace().status = 101;
            channel = std::move(made);
        }
        void in_turns(std::uint64_t, bus::Shares::Job step) override {
            for (steps = 1; step(); ++steps) {
            }
        }
        bool waits_for(std::uint64_t) const override { return !response; }
        std::size_t steps = 0;  // of a long answer
        int status() const { return response ? response->status : 0; }
        nlohmann::json body() const {
            return nlohmann::json::parse(response ? response->text() : std::string_view(), nullptr, false);
        }
        std::string detail() const { return body().value("detail", ""); }
        std::string header(const std::string& name) const {
            for (const auto& [key, value] : response->headers)
                if (key == name) return value;
            return {};
        }
    };

    explicit ApiTest(Role role = Role::kAdmin, std::string base_path = {}) {
        program::log::configure(program::log::Level::kOff, program::log::Format::kText);
        GatewayOptions options;
        options.user = "gate";
        options.client = "gw";
        options.gate.behind_proxy = !base_path.empty();
        options.base_path = std::move(base_path);
        options.gate.hosts = {"localhost"};
        options.gate.loopback.role = role;
        options.gate.loopback.name = "loopback";
        options.gate.anonymous.name = "nobody";
        Gateway::Port port;
        port.publish = [this](mqtt::Message message) {
            if (queue_full_) return false;
            published_.push_back(std::move(message));
            return true;
        };
        port.calls.publish = port.calls.publish_first = port.publish;
        port.urgent_ready = [this] { return urgent_ready_; };
        port.calls.subscribe = [](const std::string&, mqtt::SubscribeOptions) {};
        port.calls.unsubscribe = [](const std::string&) {};
        port.calls.v5 = [] { return true; };
        port.subscribe = [](const std::string&, bool) {};
        port.unsubscribe = [](const std::string&) {};
        port.now = [this] { return at(time_); };
        port.server = [] { return http::ServerCounters{}; };
        port.exports = [] {
            return std::vector<ExportStanding>{
                {"home-assistant", "Home Assistant", true, false, "cellar", true}};
        };
        port.soon = [](const std::function<void()>& then) { then(); };
        gateway_ = std::make_unique<Gateway>(
            std::move(options), model::ModelSet::standard(), catalogue::UnitsOf(),
            [n = 0ull]() mutable { return ++n << 56; },
            [n = 0](std::size_t) mutable { return "secret-" + std::to_string(++n); }, std::move(port));
        gateway_->subscribed();
        gateway_->can_call();
        settle();
    }

    void settle() {
        for (const auto& message : std::vector<mqtt::Message>(published_))
            if (message.topic == "asip/reply/gate/$self/gw/mark") gateway_->message(message);
        published_.clear();
    }
    void bus(const std::string& topic, const std::string& payload) {
        gateway_->message(mqtt::Message{.topic = topic, .payload = payload});
    }
    void announce(const std::string& board = "uno1") {
        bus("asip/servicebus/" + board + "/$description",
            R"({"board":")" + board +
                R"(","session":"s1","seq":1,"lease":60,"firmware":{"chip":"ATmega328P"},"services":[)"
                R"({"name":"distance","id":"D","model":"distance@1","title":"Distance","count":1},)"
                R"({"name":"servo","id":"S","model":"servo@1","title":"Servos"},{"name":"X","id":"X","title":"Odd"}]})");
        bus("asip/servicebus/" + board + "/$state", "online");
    }
    std::shared_ptr<Captured> ask(const std::string& method, const std::string& target,
                                  const std::string& body = {},
                                  std::vector<std::pair<std::string, std::string>> headers = {}) {
        http::Request request;
        request.method = method;
        request.target = target;
        EXPECT_TRUE(http::split_target(request)) << target;
        request.body = body;
        request.headers = std::move(headers);
        request.headers.emplace_back("host", "localhost");
        if (method == "POST" || method == "PUT")
            request.headers.emplace_back("content-type", "application/json");
        request.peer = {"127.0.0.1", true, false};
        auto captured = std::make_shared<Captured>();
        gateway_->request(request, http::Reply(captured, 1));
        return captured;
    }
    std::shared_ptr<Captured> get(const std::string& target) { return ask("GET", target); }
    /// Answers the last command that was published.
    void answer(const std::string& payload) {
        gateway_->message(mqtt::Message{.topic = published_.back().response_topic,
                                        .payload = payload,
                                        .correlation = published_.back().correlation});
    }
    void pass(std::chrono::milliseconds time) {
        time_ += time;
        gateway_->tick();
    }

    std::chrono::milliseconds time_{0};
    bool urgent_ready_ = false;
    bool queue_full_ = false;  // to the broker
    std::vector<mqtt::Message> published_;
    std::unique_ptr<Gateway> gateway_;
};

}  // namespace asip::gateway
