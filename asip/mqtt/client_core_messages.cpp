// SPDX-License-Identifier: Apache-2.0
#include <mosquitto.h>
#include <mqtt_protocol.h>

#include <algorithm>
#include <utility>

#include "asip/mqtt/client_core.hpp"

namespace asip::mqtt {
namespace {

constexpr std::size_t kMaxPropertyBytes = 65535;
constexpr int kFirstErrorCode = 128;

/// RabbitMQ gives its error without a reason while a node of the cluster is dead on which a program had
/// subscribed to the topic. Everybody else has the message.
bool is_refusal(int reason_code) {
    return reason_code >= kFirstErrorCode && reason_code != MQTT_RC_IMPLEMENTATION_SPECIFIC;
}

bool can_be_published(const Message& message) {
    return message.qos >= 0 && message.qos <= 1 && can_be_topic(message.topic) &&
           message.payload.size() <= MQTT_MAX_PAYLOAD && message.correlation.size() <= kMaxPropertyBytes &&
           message.response_topic.size() <= kMaxPropertyBytes;
}

/// Errors that mean that the connection is gone, and nothing about the message.
bool is_connection_error(int error) {
    return error == MOSQ_ERR_NO_CONN || error == MOSQ_ERR_CONN_LOST || error == MOSQ_ERR_ERRNO ||
           error == MOSQ_ERR_TLS || error == MOSQ_ERR_NOMEM;
}

}  // namespace

bool can_be_topic(const std::string& text) {
    return !text.empty() && mosquitto_pub_topic_check(text.c_str()) == 0 &&
           text.find('\0') == std::string::npos && text.size() <= kMaxPropertyBytes &&
           mosquitto_validate_utf8(text.data(), static_cast<int>(text.size())) == 0;
}

void ClientCore::subscribe(const std::string& filter, SubscribeOptions options, Time now, Actions& out) {
    subscriptions_.add(filter, options);
    if (connected()) send_subscriptions(now, out);
}

void ClientCore::unsubscribe(const std::string& filter, Actions& out) {
    subscriptions_.remove(filter);
    if (connected()) out.push_back(action::Unsubscribe{filter});
}

void ClientCore::send_subscriptions(Time now, Actions& out) {
    for (auto& due : subscriptions_.take_due(now)) {
        due.options.qos = qos_limit_.of_subscription(due.options.qos, due.was_refused);
        out.push_back(action::Subscribe{std::move(due.filter), due.options});
    }
}

void ClientCore::subscribe_sent(const std::string& filter, std::optional<int> id, Time now) {
    if (id)
        subscriptions_.sent(*id, filter, now);
    else
        subscriptions_.not_sent(filter);
}

void ClientCore::subscribe_answered(int id, const std::vector<int>& granted, Time now, Actions& out) {
    acknowledgements_.busy(now);
    const int code = granted.empty() ? 0 : granted.front();
    const bool usable_before = subscriptions_.usable();
    const auto refusal = subscriptions_.answered(id, code < kFirstErrorCode, now, options_.random);
    if (!usable_before && subscriptions_.usable()) tell(action::Subscribed{}, out);
    if (!refusal) return;
    const std::string reason = mosquitto_reason_string(code);
    if (refusal->first) tell(action::SubscribeRefused{refusal->filter, reason}, out);
    if (refusal->give_up && brokers_.size() > 1 && connected()) {
        fail(ConnectionFailure::Kind::kRefused,
             "refuses the subscription to " + refusal->filter + ": " + reason, code, out);
    }
}

bool ClientCore::check(Actions& out) {
    if (!connected() || check_) return false;
    check_.emplace();
    out.push_back(action::Check{});
    return true;
}

void ClientCore::check_sent(std::optional<int> id) {
    if (!check_) return;
    check_->id = id;
    if (!id) check_.reset();
}

void ClientCore::unsubscribe_answered(int id, Actions& out) {
    if (!check_ || check_->id != id) return;
    check_.reset();
    tell(action::CheckAnswered{}, out);
}

bool ClientCore::message_received(const Message& message, Time now) {
    ++counters_.received;
    if (message.retain) acknowledgements_.busy(now);
    return !stopping() && phase_ != Phase::kClosed;
}

PublishResult ClientCore::publish(Message message, Priority priority, Time now, Actions& out) {
    if (phase_ == Phase::kClosed || !can_be_published(message) ||
        !outbox_.push(std::move(message), priority, now)) {
        ++counters_.refused;
        return PublishResult::kRefused;
    }
    flush(now, out);
    return outbox_.empty() ? PublishResult::kSent : PublishResult::kQueued;
}

void ClientCore::may_write(Time now, Actions& out) {
    writable_ = true;
    flush(now, out);
}

/// libmosquitto's own queue has no bound: it is given the next message only when it has written the one
/// before.
void ClientCore::flush(Time now, Actions& out) {
    while (connected() && writable_ && !sending_ && !outbox_.empty() &&
           window_open(outbox_.front().message)) {
        auto entry = outbox_.pop();
        if (entry.expired(now)) {
            ++counters_.expired;
            tell(action::Debug{"not published on " + entry.message.topic +
                               ": its time was over before it could be"},
                 out);
            continue;
        }
        entry.age(now);
        const int wanted = std::exchange(entry.message.qos, qos_of(entry.message));
        sending_.emplace(std::move(entry), wanted);
        out.push_back(action::Publish{});
    }
    leave_when_sent(out);
}

void ClientCore::publish_sent(int error, int id, bool writable, Time now, Actions& out) {
    if (!sending_) return;
    writable_ = writable;
    auto& message = sending_->entry.message;
    if (is_connection_error(error)) {
        put_back_unsent();
        if (connected()) fail(ConnectionFailure::Kind::kClosed, "closed the connection", 0, out);
        return;
    }
    if (error != MOSQ_ERR_SUCCESS) {
        const bool too_large = error == MOSQ_ERR_OVERSIZE_PACKET;
        ++(too_large ? counters_.too_large : counters_.rejected);
        if (too_large)
            tell(action::PublishDenied{message.topic, "a message of " + std::to_string(message.bytes()) +
                                                          " bytes, where the broker takes packets up to " +
                                                          std::to_string(max_packet_bytes_) +
                                                          " bytes (Mosquitto: max_packet_size)"},
                 out);
        tell(action::Debug{"not published on " + message.topic + ": " + mosquitto_strerror(error)}, out);
    } else {
        closes_when_denied_.sent(now, message.payload.size());
        if (message.qos > 0) {
            acknowledgements_.sent(id, std::move(sending_->entry), now);
        } else {
            ++counters_.published;
            if (sending_->wanted_qos > 0) tell(action::Published{std::move(message.topic)}, out);
        }
    }
    sending_.reset();
    flush(now, out);
}

void ClientCore::publish_answered(int id, int reason_code, Time now, Actions& out) {
    auto entry = acknowledgements_.answered(id);
    if (!entry) return;  // QoS 0: libmosquitto reports these as well
    auto& topic = entry->message.topic;
    if (is_refusal(reason_code)) {
        const std::string reason = mosquitto_reason_string(reason_code);
        ++counters_.rejected;
        tell(action::PublishDenied{topic, reason}, out);
        tell(action::Debug{"broker rejected what was published on " + topic + ": " + reason}, out);
    } else {
        ++counters_.published;
        tell(action::Published{std::move(topic)}, out);
    }
    flush(now, out);
}

void ClientCore::put_back_unsent() {
    if (!sending_) return;
    sending_->entry.message.qos = sending_->wanted_qos;
    outbox_.put_back(std::move(sending_->entry));
    sending_.reset();
}

bool ClientCore::window_open(const Message& message) const {
    return qos_of(message) == 0 ||
           acknowledgements_.size() < std::min(Acknowledgements::kMax, receive_maximum_);
}

}  // namespace asip::mqtt
