// SPDX-License-Identifier: Apache-2.0
#include <mosquitto.h>
#include <mqtt_protocol.h>

#include <boost/asio/post.hpp>
#include <utility>

#include "asip/mqtt/client_impl.hpp"

namespace asip::mqtt {
namespace {

/// Unacknowledged QoS 1 messages: what libmosquitto and Mosquitto both allow unless configured otherwise.
constexpr std::size_t kMaxUnacknowledged = 20;
constexpr std::size_t kMaxPropertyBytes = 65535;
constexpr int kFirstErrorCode = 128;
constexpr const char* kCheckFilter = "$check";

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

void Client::Impl::message_received(Message message) {
    if (trial_) begin(*trial_);  // 3.1.1 allows it before the answer
    if (message.topic == still_topic_ && !still_topic_.empty())
        return stand_still_.came(message.qos, Clock::now());
    if (message.qos > 0) stand_still_.heard(Clock::now());
    if (checks_delivery()) {
        const bool own = message.topic == own_topic_;
        if (own && message.payload == own_payload_) return delivery_.came(Clock::now());
        delivery_.heard(Clock::now());
        if (own) return;  // it was sent on an earlier connection
    }
    ++counters_.received;
    if (message.retain) last_subscribing_ = Clock::now();
    if (!silent() && handlers_.on_message) handlers_.on_message(message);
}

void Client::Impl::debug_line(const std::string& line) {
    if (!silent() && handlers_.on_debug) handlers_.on_debug(line);
}

void Client::Impl::subscribe(std::string filter, SubscribeOptions options) {
    subscriptions_.add(filter, options);
    if (connected()) send_subscriptions();
}

void Client::Impl::unsubscribe(const std::string& filter) {
    subscriptions_.remove(filter);
    int id = 0;
    if (up()) connection_->unsubscribe(filter, id);
}

bool Client::Impl::check(std::function<void()> answered) {
    int id = 0;
    if (!connected() || check_ || connection_->unsubscribe(kCheckFilter, id) != MOSQ_ERR_SUCCESS)
        return false;
    check_ = {id, std::move(answered)};
    return true;
}

void Client::Impl::unsubscribe_answered(int id) {
    if (!check_ || check_->id != id) return;
    const auto answered = std::move(check_->answered);
    check_.reset();
    if (!silent() && answered) answered();
}

void Client::Impl::send_subscriptions() {
    const auto now = Clock::now();
    for (const auto& due : subscriptions_.due(now))
        send(due, now);
}

std::optional<int> Client::Impl::send(const Subscriptions::Sending& due, Time now) {
    int id = 0;
    auto options = due.second;
    options.qos = usable_qos_.of(options.qos);
    if (connection_->subscribe(due.first, options, id) != MOSQ_ERR_SUCCESS) return std::nullopt;
    subscriptions_.sent(id, due.first, now);
    return id;
}

void Client::Impl::subscribe_answered(int id, const std::vector<int>& granted) {
    const auto now = Clock::now();
    last_subscribing_ = now;
    const int code = granted.empty() ? 0 : granted.front();
    if (own_subscription_ && own_subscription_->id == id) {
        own_subscription_->answered = true;
        own_subscription_->granted = code < kFirstErrorCode;
        return;
    }
    if (stand_still_subscription_ && stand_still_subscription_->id == id) {
        stand_still_subscription_->granted = code == 1;
        return;
    }
    const bool usable_before = subscriptions_.usable();
    const bool all_before = subscriptions_.all_granted();
    const bool held_back = subscriptions_.holds_back(now);
    const auto refusal = subscriptions_.answered(id, code < kFirstErrorCode, now, options_.random);
    if (first_subscription_ == id) first_subscription_.reset();
    if (trial_ && !first_subscription_) begin(*trial_);
    if (silent()) return;
    if (!usable_before && subscriptions_.usable() && handlers_.on_subscribed) handlers_.on_subscribed();
    if (!all_before && subscriptions_.all_granted() && !silent() && handlers_.on_all_subscribed)
        handlers_.on_all_subscribed();
    if (held_back && !subscriptions_.holds_back(now) && connected() && !silent()) send_subscriptions();
    if (!refusal) return;
    const std::string reason = mosquitto_reason_string(code);
    const auto advice = advice_on_topic(refusal->filter);
    if (refusal->first && handlers_.on_subscribe_refused)
        handlers_.on_subscribe_refused(refusal->filter, advice.empty() ? reason : reason + "." + advice);
    const bool too_slow = qos_failed(refusal->after);
    if (too_slow) change_identifier();
    if ((refusal->give_up || too_slow) && brokers_.size() > 1 && connection_) {
        connection_->fail({ConnectionFailure::Kind::kRefused, brokers_.current(), code,
                           brokers_.current().describe() + " refuses the subscription to " + refusal->filter +
                               ": " + reason});
    }
}

PublishResult Client::Impl::publish(Message message, Priority priority) {
    if (closed_ || !can_be_published(message)) {
        ++counters_.refused;
        return PublishResult::kRefused;
    }
    if (!outbox_.push(std::move(message), priority, Clock::now())) {
        ++counters_.refused;
        return PublishResult::kRefused;
    }
    flush();
    return outbox_.empty() ? PublishResult::kSent : PublishResult::kQueued;
}

/// libmosquitto's own queue has no bound: it is given the next message only when it has written the one
/// before.
void Client::Impl::flush() {
    while (!outbox_.empty() && connected() && connection_->ready_to_write() &&
           window_open(outbox_.front().message)) {
        auto entry = outbox_.pop();
        const auto now = Clock::now();
        if (entry.expired(now)) {
            ++counters_.expired;
            debug_line("not published on " + entry.message.topic + ": its time was over before it could be");
            continue;
        }
        entry.age(now);
        const int error = send(std::move(entry));
        if (is_connection_error(error)) {
            connection_->fail(closed_by(brokers_.current(), 0));
            break;
        }
    }
    leave_when_sent();
}

int Client::Impl::send(Outbox::Entry entry) {
    int id = 0;
    const int wanted = std::exchange(entry.message.qos, qos_of(entry.message));
    const int error = connection_->publish(entry.message, id);
    if (is_connection_error(error)) {
        entry.message.qos = wanted;
        outbox_.put_back(std::move(entry));
    } else if (error != MOSQ_ERR_SUCCESS) {
        ++(error == MOSQ_ERR_OVERSIZE_PACKET ? counters_.too_large : counters_.rejected);
        debug_line("not published on " + entry.message.topic + ": " + mosquitto_strerror(error));
    } else if (entry.message.qos == 0) {
        ++counters_.published;
        cut_off_.sent(Clock::now(), entry.message.payload.size());
        if (entry.message.retain) supersede(entry.message.topic);
        if (wanted > 0) handed_over(std::move(entry.message.topic));
    } else {
        cut_off_.sent(Clock::now(), entry.message.payload.size());
        unacknowledged_.emplace(id, Unacknowledged{std::move(entry), Clock::now()});
    }
    return error;
}

void Client::Impl::supersede(const std::string& topic) {
    for (auto& [id, sent] : unacknowledged_)
        sent.superseded = sent.superseded || (sent.entry.message.retain && sent.entry.message.topic == topic);
}

/// Of a message of QoS 1 that was sent with QoS 0 this is all that will be known.
void Client::Impl::handed_over(std::string topic) {
    boost::asio::post(io_, [self = shared_from_this(), topic = std::move(topic)] {
        if (!self->silent() && self->handlers_.on_published) self->handlers_.on_published(topic);
    });
}

void Client::Impl::publish_answered(int id, int reason_code) {
    const auto sent = unacknowledged_.find(id);
    if (sent == unacknowledged_.end()) return;  // QoS 0: libmosquitto reports these as well
    const auto topic = std::move(sent->second.entry.message.topic);
    unacknowledged_.erase(sent);
    if (reason_code >= kFirstErrorCode) {
        ++counters_.rejected;
        const std::string reason = mosquitto_reason_string(reason_code);
        if (!silent() && handlers_.on_publish_denied) handlers_.on_publish_denied(topic, reason);
        debug_line("broker rejected what was published on " + topic + ": " + reason);
    } else {
        ++counters_.published;
        if (!silent() && handlers_.on_published) handlers_.on_published(topic);
    }
    leave_when_sent();
}

// What is retained says how things are, and the next broker may not have it. The acknowledgement of anything
// else was withheld for good, and it is out of order by now.
void Client::Impl::requeue_unacknowledged(Time now) {
    for (auto& [id, sent] : unacknowledged_) {
        auto& message = sent.entry.message;
        const bool says_how_things_are = message.retain && !sent.superseded;
        if (says_how_things_are || !withheld(sent.sent, now)) {
            outbox_.put_back(std::move(sent.entry));
        } else {
            ++counters_.published;
            handed_over(std::move(message.topic));
        }
    }
    unacknowledged_.clear();
}

bool Client::Impl::window_open(const Message& message) const {
    return qos_of(message) == 0 ||
           unacknowledged_.size() < std::min(kMaxUnacknowledged, connection_->receive_maximum());
}

}  // namespace asip::mqtt
