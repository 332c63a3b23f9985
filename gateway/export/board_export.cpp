// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/board_export.hpp"

#include <utility>

namespace asip::gateway::exports {

BoardExport::BoardExport(Options options, std::string place, Random random, Port port)
    : options_(std::move(options)),
      between_(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1 / options_.per_second))),
      port_(std::move(port)),
      turn_({options_.gateway, 0, options_.host, {std::move(place)}}, std::move(random)) {}

void BoardExport::changed(std::set<std::string> boards, Time now) {
    if (phase_ != Phase::kActive) return;
    dirty_.merge(boards);
    pump(now);
}

void BoardExport::lease_said(const mqtt::Message& message, Time now) {
    const bool mine = turn_.active();
    if (turn_.said(message.payload, message.retain, now) && mine && phase_ != Phase::kIdle)
        become_idle("another gateway exports to " + std::string(title()) + "; this one waits");
}

bool BoardExport::claim(const std::string& did, Time now) {
    if (!turn_.active() && !turn_.may_claim(now)) {
        become_idle("");
        return false;
    }
    const auto holder = turn_.holder();
    retain(lease(), turn_.claim(now), 0);
    if (!holder || holder->gateway != options_.gateway) port_.log(did);
    return true;
}

bool BoardExport::keep_turn(Time now) {
    now_ = now;
    seldom_.tick(now);
    if (phase_ == Phase::kIdle && port_.ready() &&
        (options_.enabled ? turn_.may_claim(now) : turn_.may_clear(options_.clear_all, now))) {
        connect();
        return false;
    }
    if (phase_ == Phase::kConnecting && !turn_.active() && turn_.held(now)) {
        become_idle("");
        return false;
    }
    if (phase_ == Phase::kPreparing || phase_ == Phase::kActive)
        if (auto renewal = turn_.renewal(now)) retain(lease(), std::move(*renewal), 0);
    return phase_ == Phase::kActive;
}

void BoardExport::retain(std::string topic, std::string payload, int qos) {
    port_.publish(
        mqtt::Message{.topic = std::move(topic), .payload = std::move(payload), .qos = qos, .retain = true});
}

void BoardExport::take_up(ShownBoard& shown, std::shared_ptr<const ExportedBoard> board,
                          const std::function<std::size_t(const ExportedBoard&)>& bytes) {
    shown.whole = std::move(board);
    shown.board = fitting(shown.whole, bytes);
    const auto& properties = shown.board->properties;
    const auto& name = shown.board->board;
    if (properties.size() < shown.whole->properties.size())
        seldom_.say(name, left_out_text(title(), *shown.whole, properties.size()), now_);
    shown.by_service.clear();
    for (std::size_t i = 0; i < properties.size(); ++i)
        if (properties[i].read) shown.by_service[properties[i].service].push_back(i);
    // The new ones first: what both want stays demanded.
    std::vector<bus::Demander::Want> wants;
    for (const auto& [service, indices] : shown.by_service)
        wants.push_back(port_.want(name, service, options_.per_second));
    shown.wants = std::move(wants);
}

}  // namespace asip::gateway::exports
