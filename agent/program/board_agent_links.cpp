// SPDX-License-Identifier: Apache-2.0
// Links: what is kept of them, and the sources that they have.
#include <boost/asio/post.hpp>
#include <utility>

#include "agent/program/board_agent.hpp"

namespace asip::agent {

BoardAgent::~BoardAgent() {
    host_.agents.erase(this);
    for (auto* other : host_.agents)
        if (other->heard_.erase(bridge_.name()) > 0)
            boost::asio::post(io_, [other, alive = std::weak_ptr(other->alive_), name = bridge_.name()] {
                if (alive.expired()) return;
                other->with_bridge(
                    [&](Time now, Effects& out) { other->bridge_.source_gone(name, now, out); });
            });
}

void BoardAgent::keep_links(std::vector<LinkToKeep> links) {
    boost::asio::post(host_.disk, [this, alive = std::weak_ptr(alive_), &io = io_, files = link_files_,
                                   board = bridge_.name(), links = std::move(links)] {
        for (const auto& link : links)
            boost::asio::post(io, [this, alive, ticket = link.ticket,
                                   result = files.save(board, link.name, link.text)] {
                if (!alive.expired())
                    with_bridge([&](Time now, Effects& out) { bridge_.link_kept(ticket, result, now, out); });
            });
    });
}

void BoardAgent::subscribe_to_sources() {
    if (std::exchange(sources_of_, bridge_.source_changes()) == bridge_.source_changes()) return;
    auto wanted = bridge_.source_subscriptions();
    if (wanted.empty()) {
        sources_.clear();
        boost::asio::post(io_, [bus = std::move(source_bus_)] {});  // this may be a call of its own
        return;
    }
    if (!source_bus_) {
        auto options = options_.mqtt;
        options.client_id += options.client_id.empty() ? "" : "-sources";
        options.will.reset();
        source_bus_ = std::make_unique<mqtt::Client>(io_, std::move(options), source_handlers());
        source_bus_->start();
        sources_.clear();
    }
    for (const auto& filter : wanted)
        if (!sources_.contains(filter)) source_bus_->subscribe(filter, {.qos = 1});
    for (const auto& filter : sources_)
        if (!wanted.contains(filter)) source_bus_->unsubscribe(filter);
    sources_ = std::move(wanted);
}

mqtt::Client::Handlers BoardAgent::source_handlers() {
    mqtt::Client::Handlers handlers;
    const auto failed = [this](const mqtt::ConnectionFailure& failure) {
        // Where the whole broker is away, the board's own connection says it.
        if (bus_ && why_no_broker_.empty() && std::exchange(why_no_sources_, failure.text) != failure.text)
            log_.warning("sources of links are not heard", {{"why", failure.text}});
    };
    handlers.on_connected = [this](const mqtt::Connected&) {
        why_no_sources_.clear();
        sources_heard(true);
    };
    handlers.on_connect_failed = failed;
    handlers.on_disconnected = [this, failed](const mqtt::ConnectionFailure& failure) {
        failed(failure);
        sources_heard(false);
    };
    handlers.on_message = [this](const mqtt::Message& message) {
        note_running();
        if (const auto topic = topics_.parse(message.topic); topic && !ended())
            source_shares_.message(topic->board, message, Clock::now());
    };
    handlers.on_subscribe_refused = [this](const std::string& filter, const std::string& reason) {
        reports_.subscription_refused(filter, reason);
    };
    return handlers;
}

void BoardAgent::sources_heard(bool heard) {
    if (ended()) return;
    if (!heard) {
        source_shares_.disconnected();
        for (const auto& neighbour : heard_)  // those need no broker
            hear_soon(neighbour);
    }
    bridge_.sources_heard(heard, Clock::now());
    arm_timer();
}

void BoardAgent::hear_source(const mqtt::Message& message) {
    const auto topic = topics_.parse(message.topic);
    for (auto* other : host_.agents)
        if (topic && topic->kind != bus::TopicKind::kDescription && other->bridge_.name() == topic->board)
            return with_bridge([&](Time now, Effects& out) {
                bridge_.source_stands(other->bridge_.standing(now), now, out);
            });
    with_bridge([&](Time now, Effects& out) { bridge_.source_message(message, now, out); });
}

void BoardAgent::share_turn() {
    boost::asio::post(io_, [this, alive = std::weak_ptr(alive_)] {
        if (!alive.expired() && !ended() && shares_.run()) share_turn();
    });
}

void BoardAgent::look_for_neighbours() {
    std::erase_if(heard_, [this](const auto& each) { return !bridge_.has_source(each); });
    for (auto* other : host_.agents)
        if (bridge_.has_source(other->bridge_.name()) && heard_.insert(other->bridge_.name()).second)
            hear_soon(other->bridge_.name());
    if (bus_ && bridge_.name_claimed() && to_hear_.empty()) subscribe_to_sources();
}

void BoardAgent::tell_neighbours() {
    if (bridge_.name().empty() ||
        std::exchange(told_, bridge_.standing_changes()) == bridge_.standing_changes())
        return;
    for (auto* other : host_.agents)
        if (other->heard_.contains(bridge_.name()) && other->bridge_.has_source(bridge_.name()))
            other->in_bridge_ ? other->hear_soon(bridge_.name()) : other->hear_neighbour(bridge_.name());
}

void BoardAgent::hear_neighbour(const std::string& source) {
    mqtt::Message message;
    message.topic = topics_.values(source);
    source_shares_.message(source, message, Clock::now());
}

/// In a turn of its own, however often the neighbour changes before.
void BoardAgent::hear_soon(const std::string& source) {
    if (!to_hear_.insert(source).second) return;
    boost::asio::post(io_, [this, source, alive = std::weak_ptr(alive_)] {
        if (alive.expired()) return;
        to_hear_.erase(source);
        hear_neighbour(source);
    });
}

}  // namespace asip::agent
