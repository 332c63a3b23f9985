// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/client_core.hpp"

#include <mqtt_protocol.h>

#include <algorithm>
#include <utility>

namespace asip::mqtt {
namespace {

using Kind = ConnectionFailure::Kind;

Options completed(Options options) {
    if (options.brokers.empty()) options.brokers.emplace_back();
    if (!options.random) options.random = system_random();
    if (options.client_id.empty()) options.client_id = "asip-" + random_hex(options.random, 12);
    return options;
}

bool refuses_identifier(int connack_code) {
    return connack_code == CONNACK_REFUSED_IDENTIFIER_REJECTED ||
           connack_code == CONNACK_REFUSED_NOT_AUTHORIZED || connack_code == MQTT_RC_CLIENTID_NOT_VALID ||
           connack_code == MQTT_RC_NOT_AUTHORIZED;
}

}  // namespace

ClientCore::ClientCore(Options options, Identifier::Secrets secrets)
    : options_(completed(std::move(options))),
      brokers_(options_.brokers, options_.version, Backoff(options_.retry_first, options_.retry_max)),
      identifier_(options_.client_id, options_.brokers.size() > 1, std::move(secrets)),
      acknowledgements_(options_.ack_timeout),
      outbox_({options_.max_queued_messages, options_.max_queued_bytes}) {}

void ClientCore::start(Actions& out) {
    if (phase_ == Phase::kIdle) attempt(out);
}

void ClientCore::attempt(Actions& out) {
    phase_ = Phase::kConnecting;
    tried_v5_ = brokers_.with_v5();
    auto will = options_.will;
    if (will) will->qos = qos_limit_.of(will->qos);
    out.push_back(action::Connect{brokers_.current(), tried_v5_, identifier_.current(), std::move(will)});
}

void ClientCore::connection_up(const Accepted& accepted, Time now, Actions& out) {
    phase_ = Phase::kUp;
    up_since_ = now;
    v5_ = accepted.connected.v5;
    receive_maximum_ = accepted.receive_maximum;
    max_packet_bytes_ = accepted.connected.max_packet_bytes;
    ++counters_.connects;
    brokers_.accepted();
    qos_limit_.broker_allows(accepted.max_qos);
    acknowledgements_.busy(now);
    subscriptions_.restart();
    send_subscriptions(now, out);
    auto connected = accepted.connected;
    connected.client_id = options_.client_id;
    tell(action::Established{std::move(connected)}, out);
}

void ClientCore::connection_down(const ConnectionEnd& end, Time now, Actions& out) {
    const bool was_up = phase_ == Phase::kUp || phase_ == Phase::kEnding;
    writable_ = false;
    check_.reset();
    acknowledgements_.drain([&](Outbox::Entry entry) { outbox_.put_back(std::move(entry)); });
    put_back_unsent();
    if (stopping()) return finish(out);
    if (!was_up && end.failure.code == MQTT_RC_QOS_NOT_SUPPORTED && qos_limit_.broker_allows(0))
        return attempt(out);  // the QoS of the will was too high
    phase_ = Phase::kWaiting;
    ++counters_.failures;
    if (was_up) {
        auto failure = end.failure;
        identifier_.connection_lost();
        closes_when_denied_.ended(failure, now - up_since_, options_.user, now);
        retry_at_ = now + std::max(brokers_.lost(end, now - up_since_, options_.random).wait,
                                   closes_when_denied_.pause(brokers_.size()));
        return tell(action::Lost{std::move(failure)}, out);
    }
    if (refuses_identifier(end.failure.code)) identifier_.refused();
    auto next = brokers_.failed(end, tried_v5_, options_.random);
    retry_at_ = now + next.wait;
    if (next.failure) tell(action::AttemptFailed{std::move(*next.failure)}, out);
}

void ClientCore::tick(bool unread, Time now, Actions& out) {
    if (stop_ && now >= stop_->end_at) return finish(out);
    if (stop_ && now >= stop_->hurry_at && !std::exchange(hurries_, true)) flush(now, out);
    if (phase_ == Phase::kWaiting && now >= retry_at_) return attempt(out);
    if (phase_ != Phase::kUp) return;
    fail_if_stalled(unread, now, out);
    if (!connected() || stopping()) return;
    send_subscriptions(now, out);
}

std::optional<Time> ClientCore::next_deadline() const {
    if (phase_ == Phase::kClosed) return std::nullopt;
    if (stop_) return hurries_ ? stop_->end_at : stop_->hurry_at;
    return phase_ == Phase::kWaiting ? std::optional(retry_at_) : std::nullopt;
}

void ClientCore::fail(Kind kind, const std::string& what, int code, Actions& out) {
    phase_ = Phase::kEnding;
    out.push_back(action::Fail{{kind, brokers_.current(), code, brokers_.current().describe() + " " + what}});
}

void ClientCore::fail_if_stalled(bool unread, Time now, Actions& out) {
    if (options_.ack_timeout == Duration::zero()) return;
    if (unread) return acknowledgements_.busy(now);
    if (const auto since = subscriptions_.waiting_since()) {
        if (now - *since >= options_.subscribe_timeout)
            fail(Kind::kStalled, "does not answer a subscription", 0, out);
    } else if (acknowledgements_.overdue(now)) {
        fail(Kind::kStalled, "acknowledges nothing any more", 0, out);
    }
}

void ClientCore::stop(Duration limit, Time now, Actions& out) {
    if (stopping() || phase_ == Phase::kClosed) return;
    if (!connected()) return finish(out);
    // The last quarter is for messages whose predecessors are not acknowledged, and for DISCONNECT.
    stop_ = Stop{now + limit * 3 / 4, now + limit};
    flush(now, out);
}

void ClientCore::leave_when_sent(Actions& out) {
    if (!stopping() || !connected() || sending_ || !outbox_.empty()) return;
    if (acknowledgements_.size() > 0 && !hurries_) return;
    phase_ = Phase::kEnding;
    out.push_back(action::Goodbye{});
}

void ClientCore::finish(Actions& out) {
    if (phase_ == Phase::kClosed) return;
    phase_ = Phase::kClosed;
    out.push_back(action::Abandon{});
    out.push_back(action::Stopped{});
}

Counters ClientCore::counters() const {
    auto counters = counters_;
    counters.dropped_context = outbox_.dropped();
    counters.queued = outbox_.size();
    counters.queued_bytes = outbox_.bytes();
    counters.unacknowledged = acknowledgements_.size();
    return counters;
}

void ClientCore::tell(action::Action action, Actions& out) const {
    if (!stopping() && phase_ != Phase::kClosed) out.push_back(std::move(action));
}

}  // namespace asip::mqtt
