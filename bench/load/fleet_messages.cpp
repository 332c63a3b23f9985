// SPDX-License-Identifier: Apache-2.0
// What goes between the boards and their connections.
#include <algorithm>
#include <boost/asio/post.hpp>

#include "asip/program/log.hpp"
#include "bench/load/fleet.hpp"

namespace asip::load {

namespace log = program::log;

void Fleet::later(std::function<void()> call) {
    boost::asio::post(io_, std::move(call));
}

void Fleet::publish(std::size_t board, member::Announcements& out) {
    const auto& client = carriers_[carrier_of(board)].client;
    if (!client) return;
    Slot& slot = slots_[board];
    for (auto& publication : out.publish) {
        // The description of an announcement expires, and a state after a century.
        const auto& expiry = publication.message.expiry_seconds;
        const bool description = expiry && *expiry < model::kStateExpirySeconds;
        if (description && !slot.said) slot.said = Clock::now();
        // Those of QoS 1 count when the broker has them.
        if (description && publication.message.qos == 0) ++tally_.descriptions;
        client->publish(std::move(publication.message), publication.priority);
    }
}

/// A living agent that is not ours has the name.
void Fleet::conflict(std::size_t board, const std::string& why) {
    Slot& slot = slots_[board];
    if (slot.life != Life::kPresent || ending_) return;
    ++tally_.conflicts;
    if (!std::exchange(conflict_logged_, true)) log::error(why, {{"try", "--prefix"}});
    const auto place = std::find(present_.begin(), present_.end(), board);
    if (place != present_.end()) present_.erase(place);
    if (std::exchange(slot.acknowledged, false)) --announced_;
    slot.life = Life::kNever;
    slot.board.reset();
    stop_own_client(board);
}

/// It sends what it has, and goodbye.
void Fleet::stop_own_client(std::size_t board) {
    Carrier& carrier = carriers_[carrier_of(board)];
    if (!own_connection() || !carrier.client) return;
    carrier.client->stop(std::chrono::seconds(2), [this, &carrier, stopped = carrier.client.get()] {
        later([this, &carrier, stopped] {
            if (carrier.client.get() == stopped) close(carrier);
        });
    });
}

mqtt::Client::Handlers Fleet::handlers(std::size_t carrier) {
    mqtt::Client::Handlers result;
    result.on_connected = [this, carrier](const mqtt::Connected&) { connected(carrier); };
    result.on_subscribed = [this, carrier] {
        for_boards_of(carrier, [this](std::size_t board) {
            if (slots_[board].life == Life::kPresent)
                with(board, [](auto& one, Time now, auto& out) { one.on_subscribed(now, out); });
        });
    };
    result.on_disconnected = [this, carrier](const mqtt::ConnectionFailure& failure) {
        carriers_[carrier].connected = false;
        if (tally_.connections_lost++ == 0)
            log::warning("a connection was lost; it is made again", {{"why", failure.text}});
        for_boards_of(carrier, [this](std::size_t board) {
            Slot& slot = slots_[board];
            if (!slot.board || slot.life != Life::kPresent) return;
            slot.board->on_disconnected();
            if (std::exchange(slot.acknowledged, false)) --announced_;
            slot.began = Clock::now();
            slot.said.reset();
        });
    };
    result.on_connect_failed = [this](const mqtt::ConnectionFailure& failure) {
        if (tally_.attempts_failed++ == 0)
            log::warning("an attempt to connect failed", {{"why", failure.text}});
        if (failure.hopeless && on_hopeless) on_hopeless(failure.text);
    };
    result.on_message = [this, carrier](const mqtt::Message& message) { received(carrier, message); };
    result.on_published = [this](const std::string& topic) { acknowledged(topic); };
    return result;
}

void Fleet::connected(std::size_t carrier) {
    ++tally_.connections_made;
    carriers_[carrier].connected = true;
    carriers_[carrier].client->discard_queued(mqtt::Priority::kAnnouncement);
    const bool expires = carriers_[carrier].client->v5();
    for_boards_of(carrier, [this, expires](std::size_t board) {
        if (slots_[board].life == Life::kPresent)
            with(board, [=](auto& one, Time now, auto& out) { one.on_connected(now, out, expires); });
    });
}

/// On a shared connection a probe for one board is looked at by that board alone.
void Fleet::received(std::size_t carrier, const mqtt::Message& message) {
    const auto topic = topics_.parse(message.topic);
    if (!topic) return;
    const auto deliver = [&](std::size_t board) {
        if (slots_[board].life != Life::kPresent) return;
        with(board, [&](auto& one, Time now, auto& out) {
            if (one.on_message(message, now, out)) ++tally_.commands;
        });
    };
    const bool probe = topic->kind == bus::TopicKind::kProbe;
    if (probe && message.payload.empty()) return for_boards_of(carrier, deliver);
    const auto board = number(probe ? std::string_view(message.payload) : topic->board);
    if (board && carrier_of(*board) == carrier) deliver(*board);
}

void Fleet::acknowledged(const std::string& topic_text) {
    const auto topic = topics_.parse(topic_text);
    if (!topic || topic->kind != bus::TopicKind::kDescription) return;
    ++tally_.descriptions;
    const auto board = number(topic->board);
    if (!board || slots_[*board].life != Life::kPresent) return;
    if (std::exchange(slots_[*board].acknowledged, true)) return;
    ++announced_;
    tally_.announced.add(Clock::now() - slots_[*board].began);
}

void Fleet::report_values() {
    // A machine that cannot keep up makes up for a second at most.
    values_due_ = std::min(values_due_, options_.values_per_second * static_cast<double>(slots_.size()) + 1);
    for (std::size_t looked_at = 0; values_due_ >= 1 && looked_at < slots_.size(); ++looked_at) {
        const std::size_t board = next_value_++ % slots_.size();
        const Slot& slot = slots_[board];
        if (slot.life != Life::kPresent || !slot.board->announced()) continue;
        values_due_ -= 1;
        member::Announcements out;
        slot.board->report(out);
        tally_.values += out.publish.size();
        publish(board, out);
    }
}

}  // namespace asip::load
