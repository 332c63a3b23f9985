// SPDX-License-Identifier: Apache-2.0
#include <mosquitto.h>
#include <mqtt_protocol.h>

#include <algorithm>
#include <utility>

#include "asip/mqtt/client_impl.hpp"

namespace asip::mqtt {
namespace {

using Kind = ConnectionFailure::Kind;

/// A first subscription, that alone, may take so many times as long as others where there are more brokers,
/// but no longer than kMostPatience unless all may: who leaves the broker for it finds the next one waiting
/// for the same, and both have more to do behind that.
constexpr int kPatience = 2;
constexpr Duration kMostPatience = std::chrono::minutes(1);
/// An acknowledgement that waits for another node, cut off from ours. RabbitMQ gives up a node that is gone
/// after five quarters of net_ticktime.
constexpr Duration kMostUnacknowledged = std::chrono::minutes(3);

/// Also "not authorized": rules may name the identifiers of a user.
bool refuses_identifier(int code) {
    return code == CONNACK_REFUSED_IDENTIFIER_REJECTED || code == CONNACK_REFUSED_NOT_AUTHORIZED ||
           code == MQTT_RC_CLIENTID_NOT_VALID || code == MQTT_RC_NOT_AUTHORIZED;
}

}  // namespace

void Client::Impl::attempt() {
    if (silent()) return;
    addresses_.clear();
    lookup_.start(
        brokers_.current(), options_.connect_timeout,
        [self = shared_from_this()](Expected<std::vector<std::string>> addresses) {
            if (self->silent()) return;
            if (!addresses)
                return self->connection_down({unreachable(self->brokers_.current(), addresses.error())});
            self->addresses_ = std::move(*addresses);
            self->connect_next_address();
        });
}

void Client::Impl::connect_next_address() {
    const auto host = addresses_.back();
    addresses_.pop_back();
    was_up_ = false;
    tried_v5_ = brokers_.with_v5();
    options_.client_id = identifier();
    options_.keepalive = keepalive();
    if (options_.will) options_.will->qos = usable_qos_.of(options_.will->qos);
    connection_ = std::make_shared<Connection>(io_, options_, brokers_.current(), host, tried_v5_, *this);
    connection_->open();
}

void Client::Impl::connection_up(const Connected& accepted) {
    auto connected = accepted;
    connected.client_id = client_id_;
    was_up_ = true;
    up_since_ = last_subscribing_ = Clock::now();
    ++counters_.connects;
    brokers_.accepted();
    usable_qos_.broker_allows(connection_->max_qos());
    // RabbitMQ grants one subscription after the other, to all who come from a node that is gone.
    subscriptions_.restart(!tried_v5_ && brokers_.size() > 1);
    delivery_.restart(up_since_);
    own_subscription_.reset();
    stand_still_.restart(up_since_);
    stand_still_subscription_.reset();
    first_subscription_.reset();
    without_acknowledgements_ = false;
    if (!asks_for_one_first() || !try_first_subscription(connected)) begin(connected);
}

// A node of RabbitMQ that waits for another one answers CONNECT at once and a subscription much later. Each
// connection that was left there has all it asked for done nevertheless, before those that came after it. So
// whoever has left a broker that stood still, which the next one may be waiting for, asks for one
// subscription, and for the rest, and publishes, when that has an answer. It answers no ping meanwhile, and
// counts our silence behind that.
bool Client::Impl::asks_for_one_first() const {
    return left_stalled_ && options_.ack_timeout != Duration::zero();
}

bool Client::Impl::try_first_subscription(const Connected& connected) {
    const auto due = subscriptions_.due(up_since_);
    if (due.empty()) return false;
    first_subscription_ = send(due.front(), up_since_);
    if (first_subscription_) trial_ = connected;
    return first_subscription_.has_value();
}

Duration Client::Impl::patience() const {
    if (brokers_.size() == 1) return options_.subscribe_timeout;
    return std::max(options_.subscribe_timeout,
                    std::min(kPatience * options_.subscribe_timeout, kMostPatience));
}

// It stays for the whole connection. With one broker there is nobody who is left too early.
std::chrono::seconds Client::Impl::keepalive() const {
    if (!asks_for_one_first() || brokers_.size() == 1) return keepalive_;
    return std::max(keepalive_, std::chrono::ceil<std::chrono::seconds>(std::min(patience(), kMostPatience)));
}

void Client::Impl::begin(Connected connected) {
    trial_.reset();
    delivery_.restart(Clock::now());
    send_subscriptions();
    if (!silent() && handlers_.on_connected) handlers_.on_connected(connected);
    flush();
}

void Client::Impl::connection_down(const ConnectionEnd& end) {
    connection_.reset();
    check_.reset();
    const bool tried = std::exchange(trial_, std::nullopt).has_value();
    const auto waited = unacknowledged_for(Clock::now());
    requeue_unacknowledged(Clock::now());
    if (stopped_) {
        finish();
        return;
    }
    if (was_up_) {
        was_up_ = false;
        ++counters_.failures;
        const bool stalled = end.failure.kind == Kind::kStalled;
        const bool unanswered = (stalled || end.failure.kind == Kind::kClosed) && subscribing_since();
        left_stalled_ = tried || stalled;
        const auto now = Clock::now();
        auto failure = end.failure;
        if (failure.kind == Kind::kClosed) delivery_.closed();
        cut_off_.ended(failure, now - up_since_, options_.user, now);
        const bool stores_nothing = failure.kind == Kind::kClosed && qos_failed(waited);
        // RabbitMQ keeps the queue of an identifier at the node that died, and closes whoever comes with it;
        // and closes the newer of two connections when the older one, which was left, gets its turn; and
        // whoever subscribes with an identifier whose queue it lost, for good. NATS lets nobody in under an
        // identifier whose stored session it cannot delete.
        if (failure.after_sending > 1 || stores_nothing || unanswered) change_identifier();
        retry_after(std::max(brokers_.lost(end, now - up_since_, options_.random).wait,
                             cut_off_.pause(brokers_.size())));
        const auto& handler = tried ? handlers_.on_connect_failed : handlers_.on_disconnected;
        if (handler) handler(failure);
        return;
    }
    if (end.failure.kind == Kind::kUnreachable && !addresses_.empty()) {
        connect_next_address();
        return;
    }
    // It is our will's. The same broker is asked again at once, with a lower one.
    if (end.failure.code == MQTT_RC_QOS_NOT_SUPPORTED && usable_qos_.broker_allows(0)) return attempt();
    if (refuses_identifier(end.failure.code)) identifier_ = own_identifier_;
    ++counters_.failures;
    const auto next = brokers_.failed(end, tried_v5_, options_.random);
    retry_after(next.wait);
    if (next.failure && !silent() && handlers_.on_connect_failed) handlers_.on_connect_failed(*next.failure);
}

bool Client::Impl::qos_failed(Duration waited) {
    if (!usable_qos_.failed(waited, tried_v5_)) return false;
    debug_line("QoS 0 is used from now on: the broker gave up what has QoS 1 after seconds");
    return true;
}

void Client::Impl::change_identifier() {
    identifier_ = own_identifier_ + "-" + random_hex(options_.random, 4);
}

// RabbitMQ keeps the queue of an identifier at the node where it was first connected, and gives it to whoever
// comes with that identifier to another one: what was to be delivered then waits for a node that was left
// because it is cut off, and is lost with it, while the new connection stays.
std::string Client::Impl::identifier() const {
    if (tried_v5_ || brokers_.place() == 0) return identifier_;
    return identifier_ + "-" + std::to_string(brokers_.place());
}

Duration Client::Impl::unacknowledged_for(Time now) const {
    Duration longest{};
    for (const auto& [id, sent] : unacknowledged_)
        longest = std::max(longest, now - sent.sent);
    return longest;
}

void Client::Impl::retry_after(Duration wait) {
    retry_timer_.expires_after(wait);
    retry_timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
        if (!error) self->attempt();
    });
}

void Client::Impl::tick(Time now) {
    fail_if_stalled(now);
    if (connected() && !silent()) send_subscriptions();
    if (connected() && checks_delivery()) check_delivery(now);
    if (connected() && connection_->v5() && !still_topic_.empty()) check_stand_still(now);
}

void Client::Impl::check_delivery(Time now) {
    if (connection_->has_unread()) return delivery_.behind(now);
    if (delivery_.lost(now)) {
        delivery_.leave();
        return connection_->fail(
            {Kind::kStalled, brokers_.current(), 0,
             brokers_.current().describe() + " does not deliver what is published any more"});
    }
    const bool in_doubt = unacknowledged_for(now) >= options_.ack_timeout / 2;
    if (subscriptions_.unanswered() || !connection_->ready_to_write() || !delivery_.due(now, in_doubt))
        return;
    int id = 0;
    if (!own_subscription_ && connection_->subscribe(own_topic_, {.retained = false}, id) == MOSQ_ERR_SUCCESS)
        own_subscription_ = {id, now};
    if (!own_subscription_ || !own_subscription_->granted) return;
    Message message;
    message.topic = own_topic_;
    message.payload = own_payload_ = std::to_string(++own_messages_);
    if (connection_->publish(message, id) == MOSQ_ERR_SUCCESS) delivery_.sent(now);
}

void Client::Impl::check_stand_still(Time now) {
    if (connection_->has_unread()) return stand_still_.behind(now);
    if (stand_still_.found(now))
        return connection_->fail(
            {Kind::kStalled, brokers_.current(), 0,
             brokers_.current().describe() +
                 " delivers nothing any more that has QoS 1; was a message too large for "
                 "us? Its limit (max_packet_size) must be clearly below " +
                 std::to_string(options_.max_packet_bytes) + " bytes"});
    const auto qos = stand_still_.due(now);
    if (!qos || !connection_->ready_to_write() || usable_qos_.of(1) == 0 || !window_open({.qos = *qos}))
        return;
    int id = 0;
    if (!stand_still_subscription_ &&
        connection_->subscribe(still_topic_, {.qos = 1, .retained = false}, id) == MOSQ_ERR_SUCCESS)
        stand_still_subscription_ = {id, now};
    if (!stand_still_subscription_ || !stand_still_subscription_->granted) return;
    Message message;
    message.topic = still_topic_;
    message.qos = *qos;
    if (connection_->publish(message, id) == MOSQ_ERR_SUCCESS) stand_still_.sent(now);
}

std::optional<Time> Client::Impl::subscribing_since() const {
    if (const auto since = subscriptions_.waiting_since()) return since;
    if (own_subscription_ && !own_subscription_->answered) return own_subscription_->sent;
    return std::nullopt;
}

void Client::Impl::fail_if_stalled(Time now) {
    if (options_.ack_timeout == Duration::zero()) return;
    do_without_what_is_withheld(now);
    // The acknowledgement may be among what waits.
    if (connection_->has_unread()) {
        last_behind_ = now;
        return;
    }
    const auto stalled = [&](const char* what) {
        connection_->fail({Kind::kStalled, brokers_.current(), 0, brokers_.current().describe() + what});
    };
    if (const auto since = subscribing_since()) {
        if (now - *since >= (first_subscription_ ? patience() : options_.subscribe_timeout))
            stalled(" does not answer a subscription");
        return;
    }
    for (const auto& [id, sent] : unacknowledged_) {
        if (now - std::max({sent.sent, last_subscribing_, last_behind_}) < options_.ack_timeout) continue;
        if (!delivery_.works(now) || now - sent.sent >= kMostUnacknowledged)
            return stalled(" acknowledges nothing any more");
    }
}

// A broker of a cluster may acknowledge only what has reached each listener, at whichever node. While one of
// them is cut off each of the others is like this one, and takes no new subscription.
bool Client::Impl::withheld(Time published, Time now) const {
    return options_.ack_timeout != Duration::zero() && now - published >= options_.ack_timeout &&
           delivery_.took(published);
}

void Client::Impl::do_without_what_is_withheld(Time now) {
    const bool any = std::any_of(unacknowledged_.begin(), unacknowledged_.end(),
                                 [&](const auto& each) { return withheld(each.second.sent, now); });
    if (std::exchange(without_acknowledgements_, any) == any) return;
    debug_line(any ? "the broker delivers and acknowledges nothing; QoS 0 is used until it does"
                   : "the broker acknowledges again");
    flush();
}

}  // namespace asip::mqtt
