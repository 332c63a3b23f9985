// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/properties.hpp"

#include <mqtt_protocol.h>

#include <algorithm>
#include <cstdlib>

namespace asip::mqtt {
namespace {

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

}  // namespace

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

}  // namespace asip::mqtt
