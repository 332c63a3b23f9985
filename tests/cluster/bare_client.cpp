// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/bare_client.hpp"

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

}  // namespace

BareClient::BareClient(asip::mqtt::Options options)
    : options_(std::move(options)),
      topic_("cluster-test/" + options_.client_id),
      thread_([this] { run(); }) {}

BareClient::~BareClient() {
    over_ = true;
    thread_.join();
}

void BareClient::look_anew() {
    since_ = now();
    heard_ = 0;
}

std::optional<Millis> BareClient::heard() const {
    const Millis heard = heard_;
    return heard == 0 ? std::nullopt : std::optional(heard);
}

void BareClient::received(const std::string& payload) {
    if (heard_ == 0 && std::strtoll(payload.c_str(), nullptr, 10) >= since_) heard_ = now();
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
            mosquitto_subscribe(connected, nullptr, static_cast<BareClient*>(self)->topic_.c_str(), 0);
        });
        mosquitto_message_callback_set(
            client.get(), [](mosquitto*, void* self, const mosquitto_message* message) {
                static_cast<BareClient*>(self)->received(std::string(
                    static_cast<char*>(message->payload), static_cast<std::size_t>(message->payloadlen)));
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
        const auto payload = std::to_string(now());
        mosquitto_publish(client, nullptr, topic_.c_str(), static_cast<int>(payload.size()), payload.data(),
                          0, false);
    }
}

}  // namespace cluster
