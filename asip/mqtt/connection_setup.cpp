// SPDX-License-Identifier: Apache-2.0
#include <mosquitto.h>
#include <mqtt_protocol.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "asip/mqtt/connection.hpp"

namespace asip::mqtt {

namespace {

struct FreeProperties {
    void operator()(mosquitto_property* list) const { mosquitto_property_free_all(&list); }
};
using Properties = std::unique_ptr<mosquitto_property, FreeProperties>;

std::string take(char* text) {
    std::string copy = text == nullptr ? "" : text;
    std::free(text);
    return copy;
}

void keep(std::string name, std::string value, Message& message) {
    auto& kept = message.user_properties;
    const bool known =
        std::find(kUserProperties.begin(), kUserProperties.end(), name) != kUserProperties.end();
    const bool there =
        std::any_of(kept.begin(), kept.end(), [&](const auto& each) { return each.first == name; });
    if (known && !there && value.size() <= kMaxUserPropertyBytes)
        kept.emplace_back(std::move(name), std::move(value));
}

void read_user_properties(const mosquitto_property* list, Message& message) {
    char* name = nullptr;
    char* value = nullptr;
    bool skip_first = false;
    while ((list = mosquitto_property_read_string_pair(list, MQTT_PROP_USER_PROPERTY, &name, &value,
                                                       skip_first)) != nullptr) {
        keep(take(name), take(value), message);
        name = value = nullptr;
        skip_first = true;
    }
}

/// Null: there is nothing to carry.
Properties publish_properties(const Message& message) {
    mosquitto_property* list = nullptr;
    if (!message.response_topic.empty())
        mosquitto_property_add_string(&list, MQTT_PROP_RESPONSE_TOPIC, message.response_topic.c_str());
    if (!message.correlation.empty()) {
        mosquitto_property_add_binary(&list, MQTT_PROP_CORRELATION_DATA, message.correlation.data(),
                                      static_cast<std::uint16_t>(message.correlation.size()));
    }
    if (message.expiry_seconds)
        mosquitto_property_add_int32(&list, MQTT_PROP_MESSAGE_EXPIRY_INTERVAL, *message.expiry_seconds);
    for (const auto& [name, value] : message.user_properties)
        mosquitto_property_add_string_pair(&list, MQTT_PROP_USER_PROPERTY, name.c_str(), value.c_str());
    return Properties(list);
}

/// Fills in the members that travel as properties. `list` may be null.
void read_properties(const mosquitto_property* list, Message& message) {
    if (list == nullptr) return;
    char* topic = nullptr;
    if (mosquitto_property_read_string(list, MQTT_PROP_RESPONSE_TOPIC, &topic, false) != nullptr)
        message.response_topic = take(topic);
    void* data = nullptr;
    std::uint16_t size = 0;
    if (mosquitto_property_read_binary(list, MQTT_PROP_CORRELATION_DATA, &data, &size, false) != nullptr) {
        if (data != nullptr) message.correlation.assign(static_cast<const char*>(data), size);
        std::free(data);
    }
    std::uint32_t seconds = 0;
    if (mosquitto_property_read_int32(list, MQTT_PROP_MESSAGE_EXPIRY_INTERVAL, &seconds, false) != nullptr)
        message.expiry_seconds = seconds;
    read_user_properties(list, message);
}

const char* or_null(const std::string& text) {
    return text.empty() ? nullptr : text.c_str();
}

}  // namespace

int Connection::configure() {
    auto* m = mosquitto_.get();
    mosquitto_int_option(m, MOSQ_OPT_PROTOCOL_VERSION, v5_ ? MQTT_PROTOCOL_V5 : MQTT_PROTOCOL_V311);
    // Without it a QoS 1 round trip waits for a delayed acknowledgement: 44 ms instead of 0.09.
    mosquitto_int_option(m, MOSQ_OPT_TCP_NODELAY, 1);
    mosquitto_int_option(m, MOSQ_OPT_RECEIVE_MAXIMUM, Options::kReceiveMaximum);
    // Else libmosquitto writes each packet at once, and acknowledges a message before it hands it out:
    // a program that waits for what the message says would wait for that, too. See write_out().
    mosquitto_threaded_set(m, true);
    if (!options_.user.empty()) {
        const int error = mosquitto_username_pw_set(m, options_.user.c_str(), or_null(options_.password));
        if (error != MOSQ_ERR_SUCCESS) return error;
    }
    if (options_.will) {
        const auto& will = *options_.will;
        auto properties = v5_ ? publish_properties(will) : Properties{};
        const int error = mosquitto_will_set_v5(m, will.topic.c_str(), static_cast<int>(will.payload.size()),
                                                will.payload.data(), will.qos, will.retain, properties.get());
        if (error != MOSQ_ERR_SUCCESS) return error;
        static_cast<void>(properties.release());  // taken over by libmosquitto, on success only
    }
    if (v5_ && options_.max_packet_bytes != 0) limit_packets();
    return broker_.tls ? configure_tls() : MOSQ_ERR_SUCCESS;
}

/// libmosquitto takes properties of CONNECT only in its blocking call. With a port that is none, that call
/// keeps the properties and ends before it connects.
void Connection::limit_packets() {
    mosquitto_property* list = nullptr;
    mosquitto_property_add_int32(&list, MQTT_PROP_MAXIMUM_PACKET_SIZE, options_.max_packet_bytes);
    mosquitto_connect_bind_v5(mosquitto_.get(), host_.c_str(), -1, kMinKeepalive, nullptr, list);
    mosquitto_property_free_all(&list);
}

int Connection::configure_tls() {
    auto made = Tls::make(options_, broker_.host);
    if (!made) {
        tls_detail_ = made.error();
        return MOSQ_ERR_TLS;
    }
    tls_ = std::move(*made);
    auto* m = mosquitto_.get();
    mosquitto_int_option(m, MOSQ_OPT_SSL_CTX_WITH_DEFAULTS, 0);
    return mosquitto_void_option(m, MOSQ_OPT_SSL_CTX, tls_->context());
}

void Connection::set_callbacks() {
    auto* m = mosquitto_.get();
    mosquitto_connect_v5_callback_set(
        m, [](mosquitto*, void* self, int code, int, const mosquitto_property* properties) {
            static_cast<Connection*>(self)->on_connect(code, properties);
        });
    mosquitto_disconnect_v5_callback_set(m, [](mosquitto*, void* self, int code, const mosquitto_property*) {
        static_cast<Connection*>(self)->on_disconnect(code);
    });
    mosquitto_message_v5_callback_set(m, [](mosquitto*, void* self, const mosquitto_message* message,
                                            const mosquitto_property* properties) {
        static_cast<Connection*>(self)->on_message(*message, properties);
    });
    mosquitto_publish_v5_callback_set(
        m, [](mosquitto*, void* self, int id, int code, const mosquitto_property*) {
            auto& connection = *static_cast<Connection*>(self);
            ++connection.packets_seen_;
            connection.events_.publish_answered(id, code);
        });
    mosquitto_subscribe_v5_callback_set(
        m, [](mosquitto*, void* self, int id, int count, const int* granted, const mosquitto_property*) {
            auto& connection = *static_cast<Connection*>(self);
            ++connection.packets_seen_;
            connection.events_.subscribe_answered(id, std::vector<int>(granted, granted + count));
        });
    mosquitto_unsubscribe_v5_callback_set(m, [](mosquitto*, void* self, int id, const mosquitto_property*) {
        auto& connection = *static_cast<Connection*>(self);
        ++connection.packets_seen_;
        connection.events_.unsubscribe_answered(id);
    });
    mosquitto_log_callback_set(m, [](mosquitto*, void* self, int level, const char* line) {
        static_cast<Connection*>(self)->on_log(level, line);
    });
}

int Connection::send_queued(int error) {
    if (error == MOSQ_ERR_SUCCESS) error = write_out();
    if (!serving_) arm();
    return error;
}

int Connection::publish(const Message& message, int& id) {
    const auto properties = v5_ ? publish_properties(message) : Properties{};
    const int error = mosquitto_publish_v5(mosquitto_.get(), &id, message.topic.c_str(),
                                           static_cast<int>(message.payload.size()), message.payload.data(),
                                           message.qos, message.retain, properties.get());
    return send_queued(error);
}

int Connection::subscribe(const std::string& filter, const SubscribeOptions& options, int& id) {
    int flags = 0;
    if (v5_ && options.no_local) flags |= MQTT_SUB_OPT_NO_LOCAL;
    if (v5_ && !options.retained) flags |= MQTT_SUB_OPT_SEND_RETAIN_NEVER;
    const int error =
        mosquitto_subscribe_v5(mosquitto_.get(), &id, filter.c_str(), options.qos, flags, nullptr);
    return send_queued(error);
}

int Connection::unsubscribe(const std::string& filter, int& id) {
    const int error = mosquitto_unsubscribe_v5(mosquitto_.get(), &id, filter.c_str(), nullptr);
    return send_queued(error);
}

void Connection::on_connect(int code, const mosquitto_property* properties) {
    ++packets_seen_;
    if (code != 0) {
        connack_code_ = code;
        return;
    }
    phase_ = Phase::kUp;
    // Until here it explains why TLS failed.
    if (!options_.packet_log) mosquitto_log_callback_set(mosquitto_.get(), nullptr);
    Connected connected{broker_, v5_, {}, 0};
    std::uint32_t limit = 0;
    if (mosquitto_property_read_int32(properties, MQTT_PROP_MAXIMUM_PACKET_SIZE, &limit, false) != nullptr)
        connected.max_packet_bytes = limit;
    mosquitto_property_read_byte(properties, MQTT_PROP_MAXIMUM_QOS, &max_qos_, false);
    mosquitto_property_read_int16(properties, MQTT_PROP_RECEIVE_MAXIMUM, &receive_maximum_, false);
    events_.connection_up(connected);
}

void Connection::on_disconnect(int code) {
    ++packets_seen_;
    if (code >= 128) disconnect_code_ = code;
}

void Connection::on_message(const mosquitto_message& received, const mosquitto_property* properties) {
    ++packets_seen_;
    if (phase_ == Phase::kDown) return;
    Message message;
    message.topic = received.topic;
    auto size = static_cast<std::size_t>(received.payloadlen);
    if (size > Options::kShortPayload && options_.longest_payload)
        size = std::min(size, options_.longest_payload(message.topic) + 1);
    message.payload.assign(static_cast<const char*>(received.payload), size);
    message.qos = received.qos;
    message.retain = received.retain;
    read_properties(properties, message);
    events_.message_received(std::move(message));
}

void Connection::on_log(int level, const char* line) {
    if (level == MOSQ_LOG_ERR && std::strncmp(line, "OpenSSL Error", 13) == 0) tls_detail_ = line;
    if (options_.packet_log && phase_ != Phase::kDown) events_.debug_line(line);
}

}  // namespace asip::mqtt
