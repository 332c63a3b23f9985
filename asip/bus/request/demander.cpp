// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/demander.hpp"

#include <algorithm>

#include "asip/bus/pattern.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/description.hpp"

namespace asip::bus {
namespace {

constexpr Duration kBetween = std::chrono::milliseconds(250);       // two demands to one board
constexpr Duration kSettled = std::chrono::seconds(1);              // an announcement asks no sooner
constexpr Duration kAnswerWithin = std::chrono::milliseconds(200);  // many may answer to one announcement

constexpr double kLeastHz = .001, kMostHz = 1000;

bool is_pattern(const std::string& name) {
    return name.find_first_of("*?") != std::string::npos;
}

Duration part(Duration of, const Random& random) {
    return std::chrono::duration_cast<Duration>(of * random_unit(random));
}

}  // namespace

Demander::Demander(const Topics& topics, std::string_view user, std::string_view client, Random random)
    : topics_(topics), demander_(user_level(user) + "/" + std::string(client)), random_(std::move(random)) {}

Demander::Services& Demander::services_of(Wants& wants, const std::string& board) {
    return is_pattern(board) ? wants.patterns[board] : wants.boards[board];
}

Demander::Want Demander::want(const std::string& board, const std::string& service, double hz) {
    if (!can_be_demanded(service)) return nullptr;
    hz = hz > kLeastHz ? std::min(hz, kMostHz) : kLeastHz;
    auto& rates = services_of(*wants_, board)[service];
    if (rates.empty() || hz > *rates.rbegin()) wants_->changed.insert(board);
    rates.insert(hz);
    return Want(wants_.get(), [kept = std::weak_ptr<Wants>(wants_), board, service, hz](void*) {
        if (const auto wants = kept.lock()) end(*wants, board, service, hz);
    });
}

void Demander::end(Wants& wants, const std::string& board, const std::string& service, double hz) {
    auto& services = services_of(wants, board);
    auto& rates = services[service];
    rates.erase(rates.find(hz));
    if (rates.empty() || *rates.rbegin() < hz) wants.changed.insert(board);
    if (rates.empty()) services.erase(service);
    if (!services.empty()) return;
    wants.boards.erase(board);
    wants.patterns.erase(board);
}

void Demander::schedule(const std::string& name, Board& board, Time when) {
    if (board.next) schedule_.erase({*board.next, name});
    board.next = when;
    schedule_.emplace(when, name);
}

void Demander::look_at_changes() {
    for (const auto& changed : std::exchange(wants_->changed, {})) {
        const auto touch = [this](const std::string& name, Board& board) {
            const Time when = board.told_at ? *board.told_at + kBetween : Time{};
            if (!board.next || when < *board.next) schedule(name, board, when);
        };
        if (!is_pattern(changed)) {
            if (const auto board = boards_.find(changed); board != boards_.end())
                touch(board->first, board->second);
            continue;
        }
        for (auto& [name, board] : boards_)
            if (matches_pattern(changed, name)) touch(name, board);
    }
}

void Demander::description(const std::string& name, bool on_demand, Time now) {
    auto known = boards_.find(name);
    if (!on_demand) {
        if (known == boards_.end()) return;
        if (known->second.next) schedule_.erase({*known->second.next, name});
        boards_.erase(known);
        return;
    }
    if (known == boards_.end()) {
        if (boards_.size() >= kMaxBoards) return;
        known = boards_.emplace(name, Board{}).first;
    }
    auto& board = known->second;
    Time when = now + part(kAnswerWithin, random_);
    if (board.told_at) when = std::max(when, *board.told_at + kSettled);
    if (!board.next || when < *board.next) schedule(name, board, when);
}

void Demander::take(const mqtt::Message& message, Time now) {
    if (!message.topic.ends_with("/$description")) return;  // most are values
    const auto topic = topics_.parse(message.topic);
    if (!topic || topic->kind != TopicKind::kDescription) return;
    bool on_demand = false;
    // Only then it is worth parsing.
    if (message.payload.find("\"on_demand\"") != std::string::npos) {
        const auto read = model::parse_description(message.payload);
        on_demand = read && read->board == topic->board && read->on_demand;
    }
    description(std::string(topic->board), on_demand, now);
}

void Demander::connected(Time now) {
    connected_ = true;
    for (auto& [name, board] : boards_) {
        board.told_at.reset();
        schedule(name, board, now + part(kAnswerWithin, random_));
    }
}

std::map<std::string, double> Demander::wanted_of(const std::string& board) const {
    std::map<std::string, double> wanted;
    const auto add = [&wanted](const Services& services) {
        for (const auto& [service, rates] : services) {
            auto& hz = wanted[service];
            hz = std::max(hz, *rates.rbegin());
        }
    };
    if (const auto named = wants_->boards.find(board); named != wants_->boards.end()) add(named->second);
    for (const auto& [pattern, services] : wants_->patterns)
        if (matches_pattern(pattern, board)) add(services);
    if (wanted.size() <= kMaxDemandedServices) return wanted;
    double most = 0;
    for (const auto& [service, hz] : wanted)
        most = std::max(most, hz);
    return {{"*", most}};
}

Time Demander::renewal(Time now) const {
    const Duration third = Duration(kDemandLease) / Duration::rep{3};
    return now + third - part(third / Duration::rep{5}, random_);
}

mqtt::Message Demander::message(const std::string& board, std::map<std::string, double> services) const {
    return mqtt::Message{.topic = topics_.demand(board, demander_),
                         .payload = to_text(Demand{std::move(services), kDemandLease}),
                         .qos = 1,
                         .expiry_seconds = static_cast<std::uint32_t>(kDemandLease.count())};
}

std::vector<mqtt::Message> Demander::due(Time now) {
    std::vector<mqtt::Message> messages;
    look_at_changes();
    while (connected_ && !schedule_.empty() && schedule_.begin()->first <= now) {
        const std::string name = schedule_.begin()->second;
        schedule_.erase(schedule_.begin());
        auto& board = boards_.at(name);
        board.next.reset();
        auto services = wanted_of(name);
        const bool wanted = !services.empty();
        if (!wanted && !board.told) continue;
        board.told = wanted;
        board.told_at = now;
        if (wanted) schedule(name, board, renewal(now));
        messages.push_back(message(name, std::move(services)));
    }
    return messages;
}

std::optional<Time> Demander::next_deadline() const {
    if (!connected_) return std::nullopt;
    if (!wants_->changed.empty()) return Time{};
    if (schedule_.empty()) return std::nullopt;
    return schedule_.begin()->first;
}

std::vector<mqtt::Message> Demander::leave() {
    std::vector<mqtt::Message> messages;
    if (!connected_) return messages;
    for (auto& [name, board] : boards_)
        if (std::exchange(board.told, false)) messages.push_back(message(name, {}));
    return messages;
}

}  // namespace asip::bus
