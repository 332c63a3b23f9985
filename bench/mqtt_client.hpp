// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <poll.h>

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace asip::bench {

using Clock = std::chrono::steady_clock;

/// An MQTT client that waits on its socket and nothing else.
class MqttClient {
  public:
    explicit MqttClient(std::uint16_t port) : mosquitto_(mosquitto_new(nullptr, true, this)) {
        mosquitto_int_option(mosquitto_, MOSQ_OPT_TCP_NODELAY, 1);
        mosquitto_int_option(mosquitto_, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
        mosquitto_message_callback_set(
            mosquitto_, [](mosquitto*, void* self, const mosquitto_message* message) {
                static_cast<MqttClient*>(self)->received_.emplace_back(
                    message->topic,
                    std::string(static_cast<char*>(message->payload), size_t(message->payloadlen)));
            });
        if (mosquitto_connect(mosquitto_, "127.0.0.1", port, 60) != 0) throw std::runtime_error("no broker");
        spin(std::chrono::milliseconds(300));
    }
    MqttClient(const MqttClient&) = delete;
    MqttClient& operator=(const MqttClient&) = delete;
    ~MqttClient() { mosquitto_destroy(mosquitto_); }
    void subscribe(const std::string& topic, int qos = 0) {
        mosquitto_subscribe(mosquitto_, nullptr, topic.c_str(), qos);
        spin(std::chrono::milliseconds(300));
    }
    void publish(const std::string& topic, const std::string& payload, int qos = 0) {
        mosquitto_publish(mosquitto_, nullptr, topic.c_str(), int(payload.size()), payload.data(), qos,
                          false);
    }
    /// Handles what arrives within `limit`; returns early with the first message.
    bool wait(std::chrono::milliseconds limit) {
        const auto end = Clock::now() + limit;
        while (received_.empty() && Clock::now() < end) {
            const short write = mosquitto_want_write(mosquitto_) ? POLLOUT : 0;
            pollfd poll_for{mosquitto_socket(mosquitto_), short(POLLIN | write), 0};
            if (poll(&poll_for, 1, 20) > 0) {
                if (poll_for.revents & POLLOUT) mosquitto_loop_write(mosquitto_, 1);
                if (poll_for.revents & POLLIN) mosquitto_loop_read(mosquitto_, 1);
            }
            mosquitto_loop_misc(mosquitto_);
        }
        return !received_.empty();
    }
    int socket() const { return mosquitto_socket(mosquitto_); }
    std::vector<std::pair<std::string, std::string>> take() { return std::exchange(received_, {}); }
    void spin(std::chrono::milliseconds time) {
        const auto end = Clock::now() + time;
        while (Clock::now() < end) {
            wait(std::chrono::milliseconds(5));
            take();
        }
    }

  private:
    mosquitto* mosquitto_;
    std::vector<std::pair<std::string, std::string>> received_;
};

}  // namespace asip::bench
