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
    if (!sources_.empty() && sources_of_ == bridge_.link_source_changes()) return;
    sources_of_ = bridge_.link_source_changes();
    auto wanted = bridge_.link_subscriptions();
    for (const auto& filter : wanted)
        if (!sources_.contains(filter)) bus_->subscribe(filter, {.qos = 1, .no_local = true});
    for (const auto& filter : sources_)
        if (!wanted.contains(filter)) bus_->unsubscribe(filter);
    sources_ = std::move(wanted);
}

void BoardAgent::source_message(const mqtt::Message& message) {
    if (const auto topic = topics_.parse(message.topic))
        source_shares_.message(topic->board, message, Clock::now());
}

void BoardAgent::share_turn() {
    boost::asio::post(io_, [this, alive = std::weak_ptr(alive_)] {
        if (!alive.expired() && !ended() && shares_.run()) share_turn();
    });
}

/// They hear it in a turn of their own.
void BoardAgent::tell_neighbours() {
    if (bus_ && bridge_.name_claimed()) subscribe_to_sources();
    std::erase_if(heard_, [this](const auto& each) { return !bridge_.has_source(each); });
    for (auto* other : host_.agents)
        if (bridge_.has_source(other->bridge_.name()) && heard_.insert(other->bridge_.name()).second)
            hear_neighbour(*other);
    if (bridge_.name().empty() ||
        std::exchange(told_, bridge_.standing_changes()) == bridge_.standing_changes())
        return;
    for (auto* other : host_.agents)
        if (other->heard_.contains(bridge_.name()) && other->bridge_.has_source(bridge_.name()))
            other->hear_neighbour(*this);
}

void BoardAgent::hear_neighbour(const BoardAgent& source) {
    boost::asio::post(io_, [this, &source, mine = std::weak_ptr(alive_), its = std::weak_ptr(source.alive_)] {
        if (mine.expired() || its.expired()) return;
        with_bridge(
            [&](Time now, Effects& out) { bridge_.source_stands(source.bridge_.standing(now), now, out); });
    });
}

}  // namespace asip::agent
