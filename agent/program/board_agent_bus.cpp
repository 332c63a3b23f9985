// SPDX-License-Identifier: Apache-2.0
// What is between the bridge and the broker: messages in their order, and what is reported of the connection.
#include <boost/asio/post.hpp>
#include <filesystem>
#include <utility>

#include "agent/inbound/continuations.hpp"
#include "agent/program/board_agent.hpp"
#include "asip/mqtt/quirks/closes_when_denied.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"
#include "asip/program/service_manager.hpp"

namespace asip::agent {

namespace log = program::log;

namespace {

constexpr auto kCountersEvery = std::chrono::seconds(10);
// A connection that was lost is back before that, where the broker is.
constexpr auto kStopsMissing = std::chrono::seconds(5);

}  // namespace

void BoardAgent::connect_bus() {
    const auto own = program::credentials_in_dir(options_.broker, bridge_.name());
    if (const auto used = own.empty() ? Expected<void>() : use_credentials(own); !used) {
        log_.error(used.error(), {});
        return finish(program::kExitUsage);
    }
    mqtt::Options options = options_.mqtt;
    options.packet_log = log::enabled(log::Level::kTrace);
    if (auto line = host_.stops.line(options); line != stop_line_) {
        stops_.reset();
        hears_stops_ = false;
        stop_line_ = std::move(line);
    }
    announced_ = false;
    options.will = bridge_.will();
    // 10,000 commands at once get as many answers at once; twice this many of them may wait.
    options.max_queued_messages = 16 * 1024;
    bus_ = std::make_unique<mqtt::Client>(io_, std::move(options), bus_handlers());
    for (auto& [filter, how] : bridge_.subscriptions())
        bus_->subscribe(std::move(filter), how);
    if (bridge_.name_claimed()) subscribe_to_commands();
    bus_->start();
}

void BoardAgent::subscribe_to_commands() {
    for (auto& [filter, how] : bridge_.control_subscriptions())
        bus_->subscribe(std::move(filter), how);
    subscribe_to_sources();
    if (stops_) return;
    stops_ = stop_line_->listen(topics_.stop(bridge_.name()),
                                {[this](const mqtt::Message& message) { message_received(message); },
                                 [this](bool heard, const std::string& why) { stops_heard(heard, why); }});
    wait_for_stops();
}

void BoardAgent::note_subscribed() {
    if (!hears_stops_ || !bus_ || !bus_->subscribed()) return;
    announced_ = bridge_.name_claimed();
    with_bridge([&](Time now, Effects& out) { bridge_.bus_subscribed(now, out); });
}

/// With what waits of it.
void BoardAgent::bus_gone() {
    announced_ = false;
    demand_shares_.disconnected();
    bridge_.bus_disconnected();
    note_online();
}

void BoardAgent::stops_heard(bool heard, const std::string& why) {
    if (ended()) return;
    if (!heard) why_no_stops_ = why;
    if (std::exchange(hears_stops_, heard) == heard) return;
    if (!heard) return wait_for_stops();
    stops_timer_.cancel();
    if (std::exchange(stops_missing_, false)) log_.info("stops arrive again", {});
    note_subscribed();
}

/// A board that does not hear stops is not online: its connection ends without a goodbye, so that the broker
/// says that the board is lost, and the next one announces it when stops arrive.
void BoardAgent::wait_for_stops() {
    stops_timer_.expires_after(kStopsMissing);
    stops_timer_.async_wait([this](boost::system::error_code error) {
        if (error || ended() || hears_stops_ || !bus_ || !bus_->connected()) return;
        if (!std::exchange(stops_missing_, true))
            log_.warning("stops do not arrive: the board is not online until they do",
                         {{"why", why_no_stops_}});
        if (!announced_) return;
        bus_gone();
        bus_.reset();
        connect_bus();
    });
}

Expected<void> BoardAgent::use_credentials(const std::string& file) {
    auto broker = options_.broker;
    const auto board = program::take_credentials(broker, file);
    if (!board) return fail(board.error());
    if (*board != bridge_.name()) return fail(file + " is not for board " + bridge_.name());
    if (broker.topic_root != options_.bridge.topic_root)
        return fail(file + " is for topic root " + broker.topic_root + ": give that by --topic-root");
    auto mqtt = program::mqtt_options(broker, "asip-agent");
    if (!mqtt) return fail(mqtt.error());
    options_.broker = std::move(broker);
    options_.mqtt = std::move(*mqtt);
    bridge_.leave_shared_topic();
    log_.info("credentials found", {{"file", file}});
    return {};
}

/// Whether they are there now, or may come: this machine has a folder of them, and its broker is a secured
/// one.
bool BoardAgent::look_for_credentials() {
    namespace fs = std::filesystem;
    const fs::path folder = options_.broker.credentials_dir;
    if (folder.empty() || !options_.broker.credentials.empty()) return false;
    if (!program::credentials_in_dir(options_.broker, bridge_.name()).empty()) {
        boost::asio::post(io_, [this] {
            if (ended()) return;
            bus_.reset();
            if (source_bus_) sources_heard(false);
            source_bus_.reset();
            sources_of_ = 0;
            connect_bus();
        });
        return true;
    }
    std::error_code error;
    if (fs::directory_iterator(folder, error) == fs::directory_iterator() || error) return false;
    reports_.credentials_missing(bridge_.name(), folder.string());
    return true;
}

mqtt::Client::Handlers BoardAgent::bus_handlers() {
    mqtt::Client::Handlers handlers;
    handlers.on_connected = [this](const mqtt::Connected& connected) {
        reports_.connected(connected, bus_->counters());
        bus_patience_.reset();
        why_no_broker_.clear();
        bus_->discard_queued(mqtt::Priority::kAnnouncement);
        with_bridge([&](Time now, Effects& out) {
            bridge_.bus_connected(now, connected.client_id, connected.v5, out);
        });
        if (stops_ && !hears_stops_) wait_for_stops();
    };
    handlers.on_subscribed = [this] { note_subscribed(); };
    handlers.on_disconnected = [this](const mqtt::ConnectionFailure& failure) {
        bus_gone();
        arm_timer();
        bus_failed(failure, true);
        if (failure.after_sending >= mqtt::ClosesWhenDenied::kTimes) reports_.announcing_denied();
    };
    handlers.on_connect_failed = [this](const mqtt::ConnectionFailure& failure) {
        bus_failed(failure, false);
    };
    handlers.on_message = [this](const mqtt::Message& message) { message_received(message); };
    handlers.on_published = [this](const std::string& topic) { note_published(topic); };
    handlers.on_publish_denied = [this](const std::string&, const std::string& reason) {
        reports_.denied(reason);
    };
    handlers.on_subscribe_refused = [this](const std::string& filter, const std::string& reason) {
        reports_.subscription_refused(filter, reason);
    };
    handlers.on_debug = [this](const std::string& line) {
        log_.trace(line);
        if (bus_) reports_.look_for_rejections(bus_->counters());  // each has its line
    };
    return handlers;
}

void BoardAgent::message_received(const mqtt::Message& message) {
    if (ended()) return;
    note_running();
    const Time now = Clock::now();
    auto inbound = bridge_.read(message, now);
    if (!inbound) return;
    if (auto* stop = std::get_if<Stop>(&*inbound)) {
        const auto behind = [&](const Inbound& other) { return sent_behind(*stop, other); };
        if (bridge_.obeys(*stop)) {
            stop->waiting = inbox_.stop(behind);
            link_inbox_.stop(behind);
        }
        return take(*inbound);
    }
    // What waits came while the board was stopped, if it was.
    if (std::holds_alternative<Resume>(*inbound) && bridge_.is_stopped())
        for (auto* waiting : {&inbox_, &link_inbox_})
            waiting->stop([](const Inbound&) { return false; });
    if (const auto* demand = std::get_if<DemandMessage>(&*inbound))
        return demand_shares_.message(
            std::string_view(demand->demander).substr(0, demand->demander.find('/')), message, now);
    if (request_of(*inbound) != nullptr && bridge_.age().commanded(now, message.qos > 0)) check_the_way();
    if (!takes_turns(*inbound)) return take(*inbound);
    auto& inbox = std::holds_alternative<LinkRequest>(*inbound) ? link_inbox_ : inbox_;
    const auto due = inbox.arrive(std::move(*inbound));
    ask_for_turn(inbox);
    if (due) take(*due);
}

void BoardAgent::take(const Inbound& message) {
    with_bridge([&](Time now, Effects& out) { bridge_.take(message, now, out); });
}

void BoardAgent::note_running() {
    const auto since = bridge_.age().runs(Clock::now(), armed_for_, continuations());
    if (!since) return;
    bridge_.not_watched(*since, Clock::now());
    if (!reads_since_) {
        reads_since_ = since;
        // Each socket that had something then is read in this turn of the loop or in the next one.
        boost::asio::post(io_, [this, alive = std::weak_ptr(alive_)] {
            if (alive.expired()) return;
            boost::asio::post(io_, [this, alive] {
                if (!alive.expired()) reads_since_.reset();
            });
        });
    }
    if (bus_) check_the_way();
}

void BoardAgent::check_the_way() {
    auto& age = bridge_.age();
    const auto due = age.next_check();
    if (!due || ended()) return;
    const Time now = Clock::now();
    if (now < *due) {
        check_timer_.expires_at(*due);
        check_timer_.async_wait([this](boost::system::error_code error) {
            if (error || ended()) return;
            note_running();
            check_the_way();
        });
        return;
    }
    const bool sent = bus_->check([this] {
        note_running();
        if (bridge_.age().check_answered(Clock::now()))
            log_.debug("the broker answered late; commands may be delayed", {});
        check_the_way();
    });
    if (sent)
        age.check_sent(now);
    else
        age.connection_changed();
}

void BoardAgent::ask_for_turn(Inbox& inbox) {
    if (ended() || !inbox.asks_for_turn()) return;
    boost::asio::post(io_, [this, &inbox] {
        for (auto left = inbox.begin_turn(); left > 0 && !ended(); --left)
            take(inbox.pop());
        ask_for_turn(inbox);
    });
}

void BoardAgent::bus_failed(const mqtt::ConnectionFailure& failure, bool was_connected) {
    if (ended()) return;
    if (std::exchange(why_no_broker_, failure.text) != failure.text) handlers_.on_changed();
    const bool may_change = !was_connected && look_for_credentials();
    if (failure.hopeless && !may_change) {
        log_.error(failure.text, {{"broker", failure.broker.describe()}});
        if (!program::supervised()) return finish(program::kExitBroker);
        return bus_->retry_in(bus_patience_.next(system_random()));
    }
    reports_.failed(failure, was_connected);
}

void BoardAgent::report_counters() {
    counters_timer_.expires_after(kCountersEvery);
    counters_timer_.async_wait([this](boost::system::error_code error) {
        if (error || ended()) return;
        if (bus_) reports_.look_for_drops(bus_->counters());
        source_shares_.tick(Clock::now());
        demand_shares_.tick(Clock::now());
        report_counters();
    });
}

void BoardAgent::publish_statistics(Duration after) {
    statistics_timer_.expires_after(after);
    statistics_timer_.async_wait([this](boost::system::error_code error) {
        if (error || ended()) return;
        if (bus_)
            with_bridge(
                [&](Time now, Effects& out) { bridge_.publish_statistics(bus_->counters(), now, out); });
        publish_statistics(options_.statistics);
    });
}

void BoardAgent::publish_log() {
    if (!bus_ || !bridge_.may_publish()) return;
    for (auto& line : log_.take()) {
        bus_->publish(mqtt::Message{.topic = topics_.log(bridge_.name()), .payload = std::move(line)},
                      mqtt::Priority::kContext);
    }
}

void BoardAgent::drop_stray_answers(Effects& effects) {
    const auto dropped = member::take_stray_answers(effects.publish, topics_, bridge_.name());
    if (!dropped.empty()) reports_.stray_answer(dropped.front());
}

void BoardAgent::note_published(const std::string& topic) {
    const auto known = topics_.parse(topic);
    if (!known || known->kind != bus::TopicKind::kDescription) return;
    // What is to be read later goes behind what commands and catalogues wait for.
    if (reports_.announced()) publish_log();
}

}  // namespace asip::agent
