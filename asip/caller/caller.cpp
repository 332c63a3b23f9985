// SPDX-License-Identifier: Apache-2.0
// The connection and its access rules, commands with their answers; holds: holds.cpp; boards: boards.cpp.
#include "asip/caller/caller.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "asip/caller/entries.hpp"
#include "asip/mqtt/failure.hpp"

namespace asip::caller {

void Access::asked(const std::string& topic, bool silent) {
    sent(topic);
    denied_in_silence_ = silent ? std::optional(topic) : std::nullopt;
}

void Access::disconnected(const mqtt::ConnectionFailure& why) {
    why_lost_ = why.text;
    // Brokers do not say that they denied a message which they do not acknowledge: Mosquitto 2.0.11 closes
    // the connection. One end may be that of the broker itself.
    denies_ = why.after_sending > 1 && !last_topic_.empty();
    if (why.after_sending > 0 && !last_topic_.empty()) cut_off_by_ = last_topic_;
}

std::string Access::role_for(const std::string& topic) const {
    if (!role_.empty()) return role_;
    return topic.ends_with("/query") ? "viewer NAME" : "operator NAME";
}

std::string Access::denied_text(const std::string& topic, const std::string& reason) const {
    return mqtt::denied_text(user_, topic, reason, role_for(topic));
}

std::string Access::may_be_denied() const {
    // It came back without an answer: a broker that only restarted is the rarer reason.
    if (cut_off_by_) return "; " + mqtt::cut_off_text(user_, *cut_off_by_, role_for(*cut_off_by_));
    if (!denied_in_silence_) return {};
    return mqtt::unanswered_text(user_, *denied_in_silence_, role_for(*denied_in_silence_));
}

Caller::Caller(Options options, const Random& random, Port port)
    : options_(std::move(options)),
      port_(std::move(port)),
      requester_(options_.name, bus::ReplyTopics(options_.topics, options_.user, options_.name)),
      demander_(options_.topics, options_.user, options_.name, random),
      view_(options_.topics, options_.units_of),
      router_([this](const std::string& filter) { port_.unsubscribe(filter); }),
      access_(options_.user, options_.role),
      watched_(options_.topics.board_names()) {
    port_.subscribe(replies().filter(), {.qos = options_.qos, .retained = false});
}

void Caller::connected(Time now) {
    access_.connected();
    view_.connected(now);
    lease_over_ = view_.next_expiry();
    demander_.connected(now);
    publish_demands(now);
}

void Caller::disconnected(const mqtt::ConnectionFailure& why, Time now) {
    access_.disconnected(why);
    view_.disconnected();
    lease_over_.reset();
    told_.clear();
    demander_.disconnected();
    publish_demands(now);
}

bool Caller::message(const mqtt::Message& message, Time now) {
    now_ = now;
    if (requester_.take(message, now)) return true;
    if (message.topic.starts_with(watched_)) look_at(message, now);
    router_.dispatch(message);
    if (message.retain) retained_at_ = now;
    return false;
}

void Caller::tick(Time now) {
    now_ = now;
    publish_demands(now);
    finish_due(now);
    for (auto each = holds_.begin(); each != holds_.end();) {
        const auto hold = each->lock();
        if (hold && hold->next && *hold->next <= now) renew(hold, now);
        each = hold ? std::next(each) : holds_.erase(each);
    }
    look_at_leases(now);
}

std::optional<Time> Caller::next_deadline() const {
    auto next = demander_.next_deadline();
    const auto also = [&next](std::optional<Time> when) {
        if (when && (!next || *when < *next)) next = when;
    };
    if (!due_.empty()) also(due_.begin()->first);
    for (const auto& each : holds_)
        if (const auto hold = each.lock()) also(hold->next);
    also(lease_over_);
    return next;
}

bool Caller::leave() {
    auto last = demander_.leave();
    for (auto& message : last)
        port_.publish(std::move(message));
    return !last.empty();
}

bool Caller::publish(mqtt::Message message) {
    access_.sent(message.topic);
    return port_.publish(std::move(message));
}

bool Caller::publish_asked(mqtt::Message message, bool first) {
    access_.asked(message.topic, !port_.v5() || message.qos == 0);
    return (first ? port_.publish_first : port_.publish)(std::move(message));
}

const std::string& Caller::Call::id() const {
    static const std::string none;
    return entry_ ? entry_->request.id() : none;
}

Caller::Call Caller::command(Command command, Done done, Time now) {
    now_ = now;
    mqtt::Message message{.topic = command.topic, .payload = std::move(command.payload), .qos = command.qos};
    // What reaches the broker while the agent is away is not delivered when it is no longer wanted.
    if (!command.lasts) message.expire_after(command.deadline);
    bus::Requester::More more{.plain = command.plain, .by = command.by, .id = std::move(command.id)};
    if (!command.lasts) more.deadline = command.deadline;
    if (command.replies) more.replies = &*command.replies;
    const auto call = std::make_shared<Call::Entry>(Call::Entry{
        std::move(command.topic), std::move(command.silence), std::move(done), now, command.late});
    call->request = requester_.ask(
        message, port_.v5(),
        [this, weak = std::weak_ptr(call)](const mqtt::Message& answer) {
            if (const auto asked = weak.lock()) finish(asked, bus::read_answer(answer.payload));
        },
        now, more);
    call->no_room = !publish_asked(std::move(message), command.first);
    due_.emplace(call->no_room ? now : now + command.deadline + kAnswerTime, call);
    return Call(call);
}

// Its place among those that are due is found empty later.
void Caller::finish(const std::shared_ptr<Call::Entry>& call, const bus::Reply& reply, bool last) {
    call->ended = true;
    if (!last) return call->done(reply);
    call->request.reset();
    if (const auto done = std::exchange(call->done, {})) done(reply);
}

void Caller::finish_due(Time now) {
    while (!due_.empty() && due_.begin()->first <= now) {
        const auto call = due_.begin()->second.lock();
        due_.erase(due_.begin());
        if (!call || !call->waits()) continue;
        if (call->no_room)
            finish(call, bus::Reply::refused(
                             std::string(bus::kRefusedQueueFull),
                             "too much waits for the broker, which is slow or away: it was not sent"));
        else
            finish(call, silence(call->silence, now - call->sent), !call->late);
    }
}

bus::Reply Caller::silence(std::string text, Duration waited) const {
    auto reply = bus::Reply::timeout(bus::kTimeoutConnection);
    if (const auto& why = access_.why_lost()) {
        reply.error = *why + ", and was not back in time";
    } else if (waited >= kTimeToAcknowledge && port_.unacknowledged && port_.unacknowledged() != 0) {
        reply.error = "the broker does not acknowledge what it is sent; does it stand still?";
    } else {
        reply.reason = bus::kTimeoutNoAnswer;
        if (text.empty()) text = bus::words_of(bus::Reply::Status::kTimeout, bus::kTimeoutNoAnswer);
        reply.error = std::move(text) + access_.may_be_denied();
    }
    return reply;
}

bool Caller::denied(const std::string& topic, const std::string& reason) {
    std::vector<std::shared_ptr<Call::Entry>> those;
    for (const auto& [due, weak] : due_)
        if (const auto call = weak.lock(); call && call->waits() && call->topic == topic)
            those.push_back(call);
    const auto reply =
        bus::Reply::refused(std::string(bus::kRefusedDenied), access_.denied_text(topic, reason));
    for (const auto& call : those)
        finish(call, reply);
    return !those.empty();
}

void Caller::end_all(const bus::Reply& reply) {
    for (const auto& [due, weak] : std::exchange(due_, {}))
        if (const auto call = weak.lock(); call && call->waits()) finish(call, reply);
}

std::string Caller::waiting_topic() const {
    for (const auto& [due, weak] : due_)
        if (const auto call = weak.lock(); call && call->waits()) return call->topic;
    return {};
}

Caller::Question Caller::ask(mqtt::Message question, mqtt::Router::OnMessage on_answer, Time now,
                             bool plain) {
    auto asked = requester_.ask(question, port_.v5(), std::move(on_answer), now, {.plain = plain});
    return publish_asked(std::move(question)) ? std::move(asked) : Question();
}

Caller::Port port_of(mqtt::Client& client) {
    Caller::Port port;
    port.publish = [&client](mqtt::Message message) {
        return client.publish(std::move(message), mqtt::Priority::kReply) != mqtt::PublishResult::kRefused;
    };
    port.subscribe = [&client](const std::string& filter, mqtt::SubscribeOptions options) {
        client.subscribe(filter, options);
    };
    port.unsubscribe = [&client](const std::string& filter) { client.unsubscribe(filter); };
    port.v5 = [&client] { return client.v5(); };
    port.unacknowledged = [&client] { return client.counters().unacknowledged; };
    return port;
}

}  // namespace asip::caller
