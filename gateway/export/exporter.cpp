// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/exporter.hpp"

#include <utility>

namespace asip::gateway::exports {
namespace {

constexpr Duration kAfterBirth = std::chrono::seconds(1);  // until the other system has subscribed

}  // namespace

Exporter::Exporter(Options options, Random random, Port port)
    : BoardExport(options, options.dialect->place(), random, std::move(port)),
      dialect_(std::move(options.dialect)),
      random_(std::move(random)) {}

std::vector<std::string> Exporter::subscriptions() const {
    return {dialect().lease(), dialect().gateway_state()};
}

std::vector<std::string> Exporter::own_subscriptions() const {
    return {dialect().status().empty() ? dialect().lease() : dialect().status()};
}

std::optional<mqtt::Message> Exporter::will() const {
    return mqtt::Message{
        .topic = dialect().gateway_state(), .payload = dialect().lost(), .qos = 1, .retain = true};
}

void Exporter::retain(std::string topic, std::string payload, int qos) {
    if (qos > 0) ++acknowledged_;
    BoardExport::retain(std::move(topic), std::move(payload), qos);
}

// --- over the gateway's connection

void Exporter::message(const mqtt::Message& message, Time now) {
    if (message.topic == dialect().lease()) {
        lease_said(message, now);
    } else if (message.topic == dialect().gateway_state()) {
        const auto changing = dialect().changing();
        if (!changing.empty() && message.payload == changing) return;
        const bool online = message.payload == dialect().online();
        turn_.state(online ? "online" : "offline", now);
        // The broker says so of an earlier connection.
        if (phase_ != Phase::kActive || online || !options_.enabled) return;
        gateway_due_ = true;
        if (changing.empty())
            show_gateway();
        else
            pump(now);
    }
}

// --- over the export's own connection

void Exporter::own_subscribed(Time now) {
    if (phase_ == Phase::kPreparing && scan_.runs()) {
        // Behind all that is retained: a message of QoS 0 would overtake those of QoS 1 that wait.
        port_.publish(mqtt::Message{.topic = mark(), .payload = "1", .qos = 1});
    }
    if (phase_ != Phase::kConnecting) return;
    if (claim((options_.enabled ? "exports boards to " : "clears what was exported to ") +
                  std::string(dialect().title()),
              now))
        begin_scan(now);
}

void Exporter::own_disconnected() {
    if (phase_ == Phase::kActive || phase_ == Phase::kPreparing) phase_ = Phase::kConnecting;
    scan_.take_all();
    scanned_.reset();
    scan_until_.reset();
}

void Exporter::own_message(const mqtt::Message& message, Time now) {
    if (scan_.runs() && message.topic == mark()) return finish_scan();
    scan_.message(message);
    if (!message.topic.empty() && message.topic == dialect().status()) {
        if (message.payload == "online" && options_.enabled) scan_at_ = now + kAfterBirth;
        return;
    }
    if (message.retain || (phase_ != Phase::kActive && !scanned_)) return;
    // In the order of the broker: what a gateway empties that took over is no longer ours.
    if (message.topic == dialect().lease()) return this->message(message, now);
    if (const auto which = dialect().command_of(message.topic)) return command(*which, message.payload);
    if (!message.payload.empty() || !options_.enabled) return;
    if (emptied_.size() < kMaxEmptied)
        emptied_.insert(message.topic);
    else
        scan_at_ = now + kPutBack;
    if (!put_back_at_) put_back_at_ = now + kPutBack;
}

void Exporter::sent(Time now) {
    if (scanned_) return look_through(now);
    if (phase_ == Phase::kActive && !(dirty_.empty() && clear_.empty())) pump(now);
}

void Exporter::become_idle(const std::string& why) {
    phase_ = Phase::kIdle;
    turn_.release();
    records_.clear();
    online_ = 0;
    dirty_.clear();
    later_.clear();
    clear_.clear();
    emptied_.clear();
    put_back_at_.reset();
    pending_.clear();
    scan_.take_all();
    scanned_.reset();
    scan_until_.reset();
    scan_at_.reset();
    sessions_at_ = {};
    if (!why.empty()) port_.log(why);
    port_.disconnect();
}

void Exporter::connect() {
    phase_ = Phase::kConnecting;
    port_.connect();
}

void Exporter::tick(Time now) {
    if (phase_ == Phase::kPreparing && scan_until_ && now >= *scan_until_) finish_scan();
    const bool shows = keep_turn(now);
    if (scanned_) return look_through(now);
    if (!shows) return;
    if (scan_at_ && now >= *scan_at_) return begin_scan(now);
    if (put_back_at_ && now >= *put_back_at_) put_back(now);
    for (auto each = pending_.begin(); each != pending_.end();) {
        const auto found = records_.find(each->first);
        const bool there = found != records_.end() && each->second < found->second.states.size();
        if (there && found->second.states[each->second].take(
                         now, between_, port_.has_room() && found->second.has_document()))
            publish_state(found->second, each->second);
        if (!there || !found->second.states[each->second].waits())
            each = pending_.erase(each);
        else
            ++each;
    }
    dirty_.merge(later_);
    pump(now);
    show_standing();
}

void Exporter::leave() {
    if (phase_ == Phase::kActive && sessions_due_ && options_.enabled && states_are_of_their_sessions())
        show_sessions(now_);
    if (phase_ == Phase::kActive || phase_ == Phase::kPreparing)
        if (options_.enabled) retain(dialect().gateway_state(), dialect().leaving());
    phase_ = Phase::kFinished;
    scanned_.reset();
    records_.clear();
}

}  // namespace asip::gateway::exports
