// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/bare_client.hpp"

#include <fmt/format.h>
#include <mosquitto.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <utility>

#include "tests/cluster/commander.hpp"

namespace cluster {

namespace {

constexpr Millis kBetweenBareMessages = 20;
constexpr auto kBetweenAttempts = std::chrono::milliseconds(10);
constexpr int kKeepAliveSeconds = 10;

std::string topics_of(std::size_t number) {
    return fmt::format("cluster-test/bare-{}/", number);
}

void send(mosquitto* client, const std::string& topic, const std::string& payload) {
    mosquitto_publish(client, nullptr, topic.c_str(), static_cast<int>(payload.size()), payload.data(), 0,
                      false);
}

}  // namespace

BareClient::BareClient(asip::mqtt::Options options, std::size_t number, std::size_t count)
    : options_(std::move(options)),
      own_(topics_of(number)),
      other_(topics_of((number + 1) % count)),
      thread_([this] { run(); }) {}

BareClient::~BareClient() {
    over_ = true;
    thread_.join();
}

void BareClient::look_anew() {
    since_ = now();
    heard_ = answered_ = 0;
}

std::optional<Millis> BareClient::known(Millis time) {
    return time == 0 ? std::nullopt : std::optional(time);
}

void BareClient::note(std::atomic<Millis>& first, const std::string& payload) const {
    if (first == 0 && std::strtoll(payload.c_str(), nullptr, 10) >= since_) first = now();
}

// To be asked: the time of asking, and where the answer is to go.
void BareClient::received(mosquitto* client, const mosquitto_message& message) {
    const std::string topic = message.topic;
    const std::string payload(static_cast<const char*>(message.payload),
                              static_cast<std::size_t>(message.payloadlen));
    if (topic == own_ + "self") return note(heard_, payload);
    if (topic == own_ + "answer") return note(answered_, payload);
    const auto space = payload.find(' ');
    if (space != std::string::npos) send(client, payload.substr(space + 1), payload.substr(0, space));
}

void BareClient::run() {
    mosquitto_lib_init();
    while (!over_) {
        const std::unique_ptr<mosquitto, decltype(&mosquitto_destroy)> client(
            mosquitto_new(options_.client_id.c_str(), true, this), mosquitto_destroy);
        const auto& broker = options_.brokers[node_];
        mosquitto_int_option(client.get(), MOSQ_OPT_TCP_NODELAY, 1);
        if (!options_.ca_file.empty())
            mosquitto_tls_set(client.get(), options_.ca_file.c_str(), nullptr, nullptr, nullptr, nullptr);
        mosquitto_connect_callback_set(client.get(), [](mosquitto* connected, void* self, int) {
            mosquitto_subscribe(connected, nullptr, (static_cast<BareClient*>(self)->own_ + "+").c_str(), 0);
        });
        mosquitto_message_callback_set(
            client.get(), [](mosquitto* connected, void* self, const mosquitto_message* message) {
                static_cast<BareClient*>(self)->received(connected, *message);
            });
        if (mosquitto_connect(client.get(), broker.host.c_str(), broker.port, kKeepAliveSeconds) ==
            MOSQ_ERR_SUCCESS)
            serve(client.get());
        else
            std::this_thread::sleep_for(kBetweenAttempts);
        if (!over_) node_ = (node_ + 1) % options_.brokers.size();
    }
}

void BareClient::serve(mosquitto* client) {
    Millis next = 0;
    while (!over_ && mosquitto_loop(client, 5, 1) == MOSQ_ERR_SUCCESS) {
        if (now() < next) continue;
        next = now() + kBetweenBareMessages;
        const auto time = std::to_string(now());
        send(client, own_ + "self", time);
        send(client, other_ + "ask", time + " " + own_ + "answer");
    }
}

}  // namespace cluster
