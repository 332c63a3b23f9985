// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asip/mqtt/client_core.hpp"

namespace asip::test {

using namespace std::chrono_literals;

/// How a simulated broker behaves, and what it was asked for.
struct SimulatedBroker {
    /// In place of CONNACK; none: the connection is accepted.
    std::optional<mqtt::ConnectionFailure::Kind> refuses{};
    int refusal_code = 0;          ///< of CONNACK
    std::string only_client_id{};  ///< any other is refused: not authorised
    bool hangs = false;            ///< accepts TCP connections and sends nothing
    bool knows_v5 = true;
    int max_qos = 2;
    std::size_t receive_maximum = 65535;
    bool answers = true;            ///< SUBSCRIBE, PUBLISH and UNSUBSCRIBE; else when answer_all() is called
    bool reads = true;              ///< else what is sent to it fills the socket
    int subscription_refusals = 0;  ///< so many subscriptions are refused
    std::string refused_filter{};   ///< always
    bool refuses_qos_1 = false;     ///< of subscriptions
    int publish_code = 0;           ///< by which it acknowledges
    bool closes_subscribers = false;
    bool closes_publishers = false;
    bool sees_goodbye = true;

    int connects = 0;
    int goodbyes = 0;
    int abandoned = 0;
    std::vector<mqtt::action::Connect> attempts{};
    std::vector<mqtt::action::Subscribe> subscriptions{};
    std::vector<std::string> unsubscriptions{};
    std::vector<mqtt::Message> published{};
};

/// A ClientCore and simulated brokers, in simulated time, and all that the program would be told.
class SimulatedBus {
  public:
    /// With brokers called "broker0", "broker1", ...
    explicit SimulatedBus(std::size_t count = 1, mqtt::Options options = {})
        : brokers(count), core(listed(std::move(options), count), [drawn = 0]() mutable {
              return "s" + std::to_string(++drawn);
          }) {}

    // What the program does.
    void start() { core.start(actions_), settle(); }
    void stop(Duration limit = 2s) { core.stop(limit, now, actions_), settle(); }
    void subscribe(const std::string& filter, mqtt::SubscribeOptions options = {.qos = 1}) {
        core.subscribe(filter, options, now, actions_), settle();
    }
    void unsubscribe(const std::string& filter) { core.unsubscribe(filter, actions_), settle(); }
    bool check() {
        const bool sent = core.check(actions_);
        settle();
        return sent;
    }
    mqtt::PublishResult publish(mqtt::Message message, mqtt::Priority priority = mqtt::Priority::kContext) {
        const auto result = core.publish(std::move(message), priority, now, actions_);
        settle();
        return result;
    }
    mqtt::PublishResult publish(std::string topic, std::string payload, int qos = 0, bool retain = false) {
        return publish(
            {.topic = std::move(topic), .payload = std::move(payload), .qos = qos, .retain = retain});
    }

    // What the broker and the network do.
    SimulatedBroker& broker() { return brokers.at(*connected_to_); }
    void deliver(const mqtt::Message& message) {
        event([=, this] {
            if (core.message_received(message, now)) messages.push_back(message);
        });
        settle();
    }
    /// The broker closes the connection.
    void close(int code = 0) { end(mqtt::closed_by(address(), code)), settle(); }
    /// The connection ends as if the broker stood still.
    void cut_off() {
        end(Kind::kStalled, 0);
        settle();
    }
    /// Answers what was asked meanwhile, and from now on.
    void answer_all() {
        broker().answers = true;
        for (auto& held : std::exchange(held_, {}))
            event(std::move(held));
        settle();
    }
    /// Reads what filled the socket.
    void read_all() {
        broker().reads = true;
        event([this] { core.may_write(now, actions_); });
        settle();
    }

    /// Time passes.
    void pass(Duration time) {
        for (const Time end = now + time; now < end;) {
            Time next = std::min(end, next_second());
            if (const auto due = core.next_deadline()) next = std::min(next, std::max(*due, now));
            if (!timed_.empty()) next = std::min(next, timed_.begin()->first);
            now = next;
            while (!timed_.empty() && timed_.begin()->first <= now) {
                events_.push_back(std::move(timed_.begin()->second));
                timed_.erase(timed_.begin());
            }
            settle();
            core.tick(unread, now, actions_);
            settle();
        }
    }
    /// Time passes until the condition holds; false: it does not within the limit.
    bool until(const std::function<bool()>& condition, Duration limit = 2min) {
        for (const Time end = now + limit; !condition() && now < end;)
            pass(100ms);
        return condition();
    }
    /// Starts, and is connected at once.
    bool connect() {
        start();
        return core.connected();
    }

    std::vector<SimulatedBroker> brokers;
    mqtt::ClientCore core;
    Time now{1h};
    bool unread = false;  ///< what the broker sent waits to be read

    std::vector<mqtt::Connected> connects;
    std::vector<mqtt::ConnectionFailure> losses;
    std::vector<mqtt::ConnectionFailure> failures;
    std::vector<mqtt::Message> messages;
    std::vector<std::string> published;
    std::vector<std::string> denied;
    std::vector<std::string> refused_filters;
    std::vector<std::string> debug_lines;
    int subscribed_calls = 0;
    int checks_answered = 0;
    int stopped = 0;
    std::function<void()> at_connect = [] {};

  private:
    using Kind = mqtt::ConnectionFailure::Kind;

    static mqtt::Options listed(mqtt::Options options, std::size_t count) {
        options.brokers.clear();
        for (std::size_t i = 0; i < count; ++i)
            options.brokers.push_back({"broker" + std::to_string(i), 1883, false});
        if (!options.random)
            options.random = [draw = std::uint64_t{0}]() mutable { return draw += 0x9e3779b97f4a7c15; };
        return options;
    }
    mqtt::BrokerAddress address() const { return core.options().brokers.at(*connected_to_); }
    Time next_second() const { return std::chrono::floor<std::chrono::seconds>(now) + 1s; }

    /// Something that happens on this connection.
    void event(std::function<void()> what) {
        events_.push_back([this, of = connection_, what = std::move(what)] {
            if (of == connection_) what();
        });
    }
    void reply(std::function<void()> what) {
        if (broker().answers)
            event(std::move(what));
        else
            held_.push_back(std::move(what));
    }
    void end_as(mqtt::ConnectionEnd how) {
        event([this, how] {
            ++connection_;
            held_.clear();
            core.connection_down(how, now, actions_);
        });
    }
    void end(mqtt::ConnectionFailure failure) { end_as(mqtt::ConnectionEnd{std::move(failure)}); }
    void end(Kind kind, int code) {
        end(mqtt::ConnectionFailure{kind, address(), code, std::string(mqtt::name_of(kind))});
    }

    /// Until nothing is left to do at this moment.
    void settle() {
        if (std::exchange(settling_, true)) return;
        while (!actions_.empty() || !events_.empty()) {
            for (std::size_t i = 0; i < actions_.size(); ++i) {
                auto action = std::move(actions_[i]);
                std::visit([this](auto& each) { perform(each); }, action);
            }
            actions_.clear();
            if (events_.empty()) continue;
            const auto next = std::move(events_.front());
            events_.pop_front();
            next();
        }
        settling_ = false;
    }

    void perform(mqtt::action::Connect& action) {
        const auto& all = core.options().brokers;
        connected_to_ =
            static_cast<std::size_t>(std::find(all.begin(), all.end(), action.broker) - all.begin());
        ++connection_;
        auto& to = broker();
        to.attempts.push_back(action);
        if (to.hangs) {
            const auto of = connection_;
            timed_.emplace(now + core.options().connect_timeout, [this, of] {
                if (of == connection_) end(Kind::kNoAnswer, 0);
            });
        } else if (to.refuses) {
            end(*to.refuses, to.refusal_code);
        } else if (action.v5 && !to.knows_v5) {
            end_as({{Kind::kRefused, address(), 1, "unknown version"}, true});
        } else if (!to.only_client_id.empty() && to.only_client_id != action.client_id) {
            end(mqtt::refused_by(address(), 0x87, core.options()));
        } else if (action.will && action.will->qos > to.max_qos) {
            end(Kind::kRefused, 0x9b);
        } else {
            ++to.connects;
            event([this, action] {
                core.connection_up(
                    {{address(), action.v5, action.client_id, 0}, broker().max_qos, broker().receive_maximum},
                    now, actions_);
            });
            if (to.reads) event([this] { core.may_write(now, actions_); });
        }
    }
    void perform(mqtt::action::Subscribe& action) {
        auto& to = broker();
        to.subscriptions.push_back(action);
        const int id = ++last_id_;
        core.subscribe_sent(action.filter, id, now);
        if (to.closes_subscribers) return end(mqtt::closed_by(address(), 0));
        const bool refused = action.filter == to.refused_filter || to.subscription_refusals > 0 ||
                             (to.refuses_qos_1 && action.options.qos > 0);
        if (to.subscription_refusals > 0) --to.subscription_refusals;
        reply([=, this] { core.subscribe_answered(id, {refused ? 0x87 : 1}, now, actions_); });
    }
    void perform(mqtt::action::Unsubscribe& action) {
        broker().unsubscriptions.push_back(action.filter);
        const int id = ++last_id_;
        reply([=, this] { core.unsubscribe_answered(id, actions_); });
    }
    void perform(mqtt::action::Check&) {
        const int id = ++last_id_;
        core.check_sent(id);
        reply([=, this] { core.unsubscribe_answered(id, actions_); });
    }
    void perform(mqtt::action::Publish&) {
        auto& to = broker();
        const auto message = core.to_send();
        to.published.push_back(message);
        const int id = ++last_id_;
        core.publish_sent(0, id, to.reads, now, actions_);
        if (to.closes_publishers) return end(mqtt::closed_by(address(), 0));
        if (message.qos > 0)
            reply([=, this, code = to.publish_code] { core.publish_answered(id, code, now, actions_); });
    }
    void perform(mqtt::action::Goodbye&) {
        ++broker().goodbyes;
        if (broker().sees_goodbye) end(mqtt::closed_by(address(), 0));
    }
    void perform(mqtt::action::Fail& action) { end(action.failure); }
    void perform(mqtt::action::Abandon&) {
        if (connected_to_) ++broker().abandoned;
        ++connection_;
    }
    void perform(mqtt::action::Established& action) {
        connects.push_back(action.connected);
        at_connect();
    }
    void perform(mqtt::action::Lost& action) { losses.push_back(action.failure); }
    void perform(mqtt::action::AttemptFailed& action) { failures.push_back(action.failure); }
    void perform(mqtt::action::Published& action) { published.push_back(action.topic); }
    void perform(mqtt::action::PublishDenied& action) { denied.push_back(action.topic); }
    void perform(mqtt::action::Subscribed&) { ++subscribed_calls; }
    void perform(mqtt::action::SubscribeRefused& action) { refused_filters.push_back(action.filter); }
    void perform(mqtt::action::CheckAnswered&) { ++checks_answered; }
    void perform(mqtt::action::Debug& action) { debug_lines.push_back(action.line); }
    void perform(mqtt::action::Stopped&) { ++stopped; }

    mqtt::Actions actions_;
    std::deque<std::function<void()>> events_;
    std::multimap<Time, std::function<void()>> timed_;
    std::vector<std::function<void()>> held_;  // answers
    std::optional<std::size_t> connected_to_;
    unsigned connection_ = 0;  // counts attempts and their ends
    int last_id_ = 0;
    bool settling_ = false;
};

}  // namespace asip::test
