// SPDX-License-Identifier: Apache-2.0
#include "tests/support/bus_probe.hpp"

#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <sys/socket.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>

namespace asip::test {
namespace {

mosquitto_property* to_properties(const mqtt::Message& message) {
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
    return list;
}

void from_properties(const mosquitto_property* list, mqtt::Message& message) {
    char* text = nullptr;
    if (mosquitto_property_read_string(list, MQTT_PROP_RESPONSE_TOPIC, &text, false) != nullptr) {
        message.response_topic = text;
        std::free(text);
    }
    void* data = nullptr;
    std::uint16_t size = 0;
    if (mosquitto_property_read_binary(list, MQTT_PROP_CORRELATION_DATA, &data, &size, false) != nullptr) {
        message.correlation.assign(static_cast<const char*>(data), size);
        std::free(data);
    }
    std::uint32_t seconds = 0;
    if (mosquitto_property_read_int32(list, MQTT_PROP_MESSAGE_EXPIRY_INTERVAL, &seconds, false) != nullptr)
        message.expiry_seconds = seconds;
}

}  // namespace

struct BusProbe::State {
    mosquitto* client = nullptr;
    bool v5 = true;
    std::atomic<bool> connected{false};
    std::atomic<int> connect_code{-1};
    std::atomic<bool> dropped{false};
    std::atomic<int> reconnects{0};
    mutable std::mutex mutex;
    std::vector<mqtt::Message> messages;
    std::map<std::string, int> filters;  ///< filter -> QoS
    std::set<int> awaited;               ///< subscriptions and publications without an answer so far
    std::set<int> answered_early;        ///< answered before the call that sent it returned
    int requests = 0;

    void expect(int id) {
        const std::lock_guard lock(mutex);
        if (answered_early.erase(id) == 0) awaited.insert(id);
    }
    void answered(int id) {
        const std::lock_guard lock(mutex);
        if (awaited.erase(id) == 0) answered_early.insert(id);
    }
    bool settled(int id) const {
        const std::lock_guard lock(mutex);
        return !awaited.contains(id);
    }

    void subscribe_again(mosquitto* instance) {
        const std::lock_guard lock(mutex);
        for (const auto& [filter, qos] : filters)
            mosquitto_subscribe(instance, nullptr, filter.c_str(), qos);
    }

    void set_callbacks() {
        mosquitto_connect_v5_callback_set(
            client, [](mosquitto* instance, void* self, int code, int, const mosquitto_property*) {
                auto& state = *static_cast<State*>(self);
                const bool again = state.connect_code == 0;
                state.connect_code = code;
                state.connected = code == 0;
                if (!again || code != 0) return;
                state.subscribe_again(instance);
                ++state.reconnects;
            });
        mosquitto_disconnect_callback_set(client, [](mosquitto* instance, void* self, int) {
            auto& state = *static_cast<State*>(self);
            state.connected = false;
            if (state.dropped) mosquitto_disconnect(instance);  // ends the thread instead of reconnecting
        });
        mosquitto_publish_callback_set(
            client, [](mosquitto*, void* self, int id) { static_cast<State*>(self)->answered(id); });
        mosquitto_subscribe_callback_set(client, [](mosquitto*, void* self, int id, int, const int*) {
            static_cast<State*>(self)->answered(id);
        });
        mosquitto_message_v5_callback_set(client, [](mosquitto*, void* self, const mosquitto_message* got,
                                                     const mosquitto_property* properties) {
            mqtt::Message message;
            message.topic = got->topic;
            message.payload.assign(static_cast<const char*>(got->payload),
                                   static_cast<std::size_t>(got->payloadlen));
            message.qos = got->qos;
            message.retain = got->retain;
            from_properties(properties, message);
            auto& state = *static_cast<State*>(self);
            const std::lock_guard lock(state.mutex);
            state.messages.push_back(std::move(message));
        });
    }
};

BusProbe::BusProbe(std::uint16_t port, std::vector<std::string> filters, Options options)
    : state_(std::make_unique<State>()) {
    static std::once_flag once;
    std::call_once(once, [] { mosquitto_lib_init(); });
    state_->v5 = options.v5;
    auto* client =
        mosquitto_new(options.client_id.empty() ? nullptr : options.client_id.c_str(), true, state_.get());
    state_->client = client;
    mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION,
                         options.v5 ? MQTT_PROTOCOL_V5 : MQTT_PROTOCOL_V311);
    mosquitto_int_option(client, MOSQ_OPT_TCP_NODELAY, 1);
    mosquitto_reconnect_delay_set(client, 1, 1, false);
    if (!options.user.empty())
        mosquitto_username_pw_set(client, options.user.c_str(), options.password.c_str());
    if (!options.ca.empty()) {
        mosquitto_tls_set(client, options.ca.c_str(), nullptr,
                          options.cert.empty() ? nullptr : options.cert.c_str(),
                          options.key.empty() ? nullptr : options.key.c_str(), nullptr);
    }
    if (options.will) {
        mosquitto_will_set(client, options.will->topic.c_str(),
                           static_cast<int>(options.will->payload.size()), options.will->payload.data(),
                           options.will->qos, options.will->retain);
    }
    state_->set_callbacks();
    mosquitto_connect_async(client, "127.0.0.1", port, 60);
    mosquitto_loop_start(client);
    if (!wait_until([&] { return state_->connect_code >= 0; }) || !state_->connected) {
        const int code = state_->connect_code;
        mosquitto_disconnect(client);
        mosquitto_loop_stop(client, false);
        mosquitto_destroy(client);
        throw std::runtime_error("probe cannot connect to port " + std::to_string(port) + ", code " +
                                 std::to_string(code));
    }
    for (const auto& filter : filters)
        subscribe(filter);
}

BusProbe::~BusProbe() {
    mosquitto_disconnect(state_->client);
    mosquitto_loop_stop(state_->client, false);
    mosquitto_destroy(state_->client);
}

void BusProbe::subscribe(const std::string& filter, int qos) {
    {
        const std::lock_guard lock(state_->mutex);
        state_->filters[filter] = qos;
    }
    int id = 0;
    mosquitto_subscribe(state_->client, &id, filter.c_str(), qos);
    state_->expect(id);
    if (!wait_until([&] { return state_->settled(id); }))
        throw std::runtime_error("no answer to the subscription of " + filter);
}

void BusProbe::publish(const mqtt::Message& message) {
    int id = 0;
    auto* properties = state_->v5 ? to_properties(message) : nullptr;
    const int error = mosquitto_publish_v5(state_->client, &id, message.topic.c_str(),
                                           static_cast<int>(message.payload.size()), message.payload.data(),
                                           message.qos, message.retain, properties);
    mosquitto_property_free_all(&properties);
    if (error != MOSQ_ERR_SUCCESS) {
        throw std::runtime_error("probe cannot publish on " + message.topic + ": " +
                                 mosquitto_strerror(error));
    }
    if (message.qos > 0) state_->expect(id);
}

void BusProbe::publish(const std::string& topic, const std::string& payload, bool retain, int qos) {
    publish(mqtt::Message{.topic = topic, .payload = payload, .qos = qos, .retain = retain});
}

bool BusProbe::all_acknowledged() {
    const std::lock_guard lock(state_->mutex);
    return state_->awaited.empty();
}

std::vector<mqtt::Message> BusProbe::messages() const {
    const std::lock_guard lock(state_->mutex);
    return state_->messages;
}

std::vector<mqtt::Message> BusProbe::messages(const std::string& topic) const {
    std::vector<mqtt::Message> found;
    for (auto& message : messages())
        if (message.topic == topic) found.push_back(std::move(message));
    return found;
}

std::optional<std::string> BusProbe::last(const std::string& topic) const {
    const auto found = messages(topic);
    return found.empty() ? std::nullopt : std::optional(found.back().payload);
}

std::size_t BusProbe::count(const std::string& topic) const {
    const std::lock_guard lock(state_->mutex);
    std::size_t found = 0;
    for (const auto& message : state_->messages)
        found += message.topic == topic;
    return found;
}

void BusProbe::clear() {
    const std::lock_guard lock(state_->mutex);
    state_->messages.clear();
}

std::optional<mqtt::Message> BusProbe::wait_for(const Match& match, std::chrono::milliseconds limit) const {
    std::optional<mqtt::Message> found;
    std::size_t looked_at = 0;
    wait_until(
        [&] {
            const std::lock_guard lock(state_->mutex);
            looked_at = std::min(looked_at, state_->messages.size());
            for (; looked_at < state_->messages.size() && !found; ++looked_at)
                if (match(state_->messages[looked_at])) found = state_->messages[looked_at];
            return found.has_value();
        },
        limit);
    return found;
}

std::optional<mqtt::Message> BusProbe::wait_for(const std::string& topic,
                                                std::chrono::milliseconds limit) const {
    return wait_for([&](const mqtt::Message& message) { return message.topic == topic; }, limit);
}

std::optional<mqtt::Message> BusProbe::wait_for(const std::string& topic, const std::string& payload,
                                                std::chrono::milliseconds limit) const {
    return wait_for(
        [&](const mqtt::Message& message) { return message.topic == topic && message.payload == payload; },
        limit);
}

std::optional<std::string> BusProbe::request(const std::string& topic, const std::string& payload,
                                             std::chrono::milliseconds limit) {
    const auto id = "request-" + std::to_string(++state_->requests);
    mqtt::Message message{.topic = topic, .payload = payload, .qos = 1};
    // ROOT/reply/USER/ASKED/CLIENT: programs with a user answer nowhere else.
    const auto root = topic.find('/');
    const auto asked = topic.substr(root + 1, topic.find('/', root + 1) - root - 1);
    const auto answers = topic.substr(0, root) + "/reply/probe/" + asked + "/" +
                         std::to_string(reinterpret_cast<std::uintptr_t>(this)) + "-" + id;
    subscribe(answers);
    if (state_->v5) {
        message.response_topic = answers;
        message.correlation = id;
    } else {
        const auto brace = payload.find('{');
        if (brace == std::string::npos)
            throw std::runtime_error("a request over 3.1.1 must be a JSON object");
        const bool empty = payload.find_first_not_of(" \t\r\n", brace + 1) == payload.find('}');
        message.payload.insert(brace + 1,
                               R"("reply_to":")" + answers + R"(","id":")" + id + (empty ? R"(")" : R"(",)"));
    }
    publish(message);
    const auto answer = wait_for(answers, limit);
    return answer ? std::optional(answer->payload) : std::nullopt;
}

bool BusProbe::connected() const {
    return state_->connected;
}

int BusProbe::reconnects() const {
    return state_->reconnects;
}

void BusProbe::drop() {
    state_->dropped = true;
    shutdown(mosquitto_socket(state_->client), SHUT_RDWR);
    wait_until([&] { return !state_->connected; });
}

}  // namespace asip::test
