// SPDX-License-Identifier: Apache-2.0
#include <mqtt_protocol.h>

#include <algorithm>
#include <cstring>

#include "asip/mqtt/connection.hpp"
#include "asip/mqtt/properties.hpp"

namespace asip::mqtt {

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
    if (mosquitto_property_read_int32(properties, MQTT_PROP_MAXIMUM_PACKET_SIZE, &limit, false) != nullptr) {
        connected.max_packet_bytes = limit;
    }
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
