// SPDX-License-Identifier: Apache-2.0
#include "registry/values/value_choice.hpp"

#include <algorithm>
#include <utility>

#include "asip/bus/pattern.hpp"
#include "asip/model/json.hpp"

namespace asip::registry {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxDashboardBytes = std::size_t{32} * 1024;
constexpr std::size_t kMaxShown = 64;

/// What is kept of a value: a number, on and off as 1 and 0, of a light its brightness. Nothing: it is none
/// of these.
std::optional<double> number_of_value(const json& value) {
    if (value.is_number()) return value.get<double>();
    if (value.is_boolean()) return value.get<bool>() ? 1 : 0;
    if (!value.is_object() || !value.contains("on") || !value["on"].is_boolean()) return std::nullopt;
    if (!value["on"].get<bool>()) return 0;
    const auto brightness = value.find("brightness");
    return brightness != value.end() && brightness->is_number() ? brightness->get<double>() : 1;
}

std::string text_member(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

bool is_there(const std::string& state) {
    return state == "online" || state == "sleeping";
}

}  // namespace

ValueChoice::ValueChoice(const bus::Topics& topics, Options options, Port port, bus::Demander demander,
                         Handlers handlers)
    : topics_(topics),
      options_(std::move(options)),
      port_(std::move(port)),
      demander_(std::move(demander)),
      handlers_(std::move(handlers)),
      dashboard_prefix_(topics.root() + "/export/dashboard/") {}

void ValueChoice::connected(Time now) {
    came_.clear();
    if (options_.demand_hz > 0) demander_.connected(now);
}

void ValueChoice::complete(const std::function<std::vector<std::string>()>& each) {
    if (std::erase_if(dashboards_, [this](const auto& one) { return !came_.contains(one.first); }) == 0)
        return;
    for (auto& board : each())
        to_look_.insert(std::move(board));
}

void ValueChoice::values_lost() {
    for (auto& [name, board] : boards_) {
        for (auto& [id, said] : board.said)
            said.value = kGap;
        apply(name, board);
    }
}

void ValueChoice::description(const mqtt::Message& message, Time now) {
    if (options_.demand_hz > 0) demander_.take(message, now);
}

bool ValueChoice::dashboard(const mqtt::Message& message,
                            const std::function<std::vector<std::string>()>& each) {
    if (!message.topic.starts_with(dashboard_prefix_)) return false;
    const auto name = message.topic.substr(dashboard_prefix_.size());
    std::vector<Shown> shown;
    const auto document =
        model::parse_json(message.payload, {.max_bytes = kMaxDashboardBytes, .max_depth = 8});
    if (document && document->is_object() && document->contains("widgets") &&
        (*document)["widgets"].is_array()) {
        for (const auto& widget : (*document)["widgets"]) {
            if (!widget.is_object() || shown.size() == kMaxShown) continue;
            Shown one{text_member(widget, "board"), {}, text_member(widget, "property")};
            if (auto labels = bus::LabelSelector::parse(text_member(widget, "labels"))) one.labels = *labels;
            if (!one.property.empty() && (one.labels || !one.board.empty())) shown.push_back(std::move(one));
        }
    }
    const auto known = dashboards_.find(name);
    if (shown.empty())
        came_.erase(name);
    else if (known != dashboards_.end() || dashboards_.size() < kMaxDashboards)
        came_.insert(name);
    if (known == dashboards_.end() ? shown.empty() : known->second == shown) return true;
    if (shown.empty())
        dashboards_.erase(known);
    else if (known != dashboards_.end() || dashboards_.size() < kMaxDashboards)
        dashboards_[name] = std::move(shown);
    for (auto& board : each())
        to_look_.insert(std::move(board));
    return true;
}

bool ValueChoice::is_shown(const Shown& shown, const std::string& name, const Board& board) const {
    return shown.labels ? shown.labels->matches(board.labels.labels) : shown.board == name;
}

bool ValueChoice::is_wanted(const std::string& name, const Board& board) const {
    if (!board.labels.services.empty() || !board.labels.pins.empty()) return true;
    for (const auto& [dashboard, all] : dashboards_)
        for (const auto& shown : all)
            if (is_shown(shown, name, board)) return true;
    return std::any_of(options_.patterns.begin(), options_.patterns.end(), [&](const std::string& pattern) {
        return bus::matches_pattern(pattern.substr(0, pattern.find('/')), name);
    });
}

bool ValueChoice::is_chosen(const std::string& name, const Board& board, const std::string& id) const {
    if (board.labels.services.contains(std::string(property::service_of(id)))) return true;
    for (const auto& [pin, label] : board.labels.pins)
        if (id == "io/" + std::to_string(pin)) return true;
    for (const auto& [dashboard, all] : dashboards_)
        for (const auto& shown : all)
            if (shown.property == id && is_shown(shown, name, board)) return true;
    return std::any_of(options_.patterns.begin(), options_.patterns.end(), [&](const std::string& pattern) {
        const auto slash = pattern.find('/');
        return bus::matches_pattern(pattern.substr(0, slash), name) &&
               bus::matches_pattern(pattern.substr(slash + 1), id);
    });
}

void ValueChoice::leave(const std::string& name) {
    const auto found = boards_.find(name);
    if (found == boards_.end()) return;
    for (const auto& [id, said] : found->second.said)
        if (said.kept) handlers_.drop({name, id});
    boards_.erase(found);
    port_.unsubscribe(topics_.values(name));
}

void ValueChoice::look(const std::string& name) {
    auto item = handlers_.look(name);
    if (!item) return leave(name);
    Board seen;
    seen.labels = std::move(item->labels);
    if (!is_wanted(name, seen)) return leave(name);
    const auto [found, added] = boards_.try_emplace(name);
    auto& board = found->second;
    board.labels = std::move(seen.labels);
    board.there = is_there(item->state);
    board.session = item->session;
    for (auto& [id, said] : board.said)
        said.chosen.reset();
    if (added) port_.subscribe(topics_.values(name), true);
    apply(name, board);
}

/// Tells everything that was said: it has changed, or the board came or went, or the choice is another one.
void ValueChoice::apply(const std::string& name, Board& board) {
    const bool counts = board.there && (board.session.empty() || board.session == board.head.session);
    std::set<std::string> demanded;
    for (auto& [id, said] : board.said) {
        if (!said.chosen) said.chosen = is_chosen(name, board, id);
        if (*said.chosen && options_.demand_hz > 0) demanded.emplace(property::service_of(id));
        if (*said.chosen && (said.kept || !std::isnan(said.value))) {
            said.kept = true;
            handlers_.set({name, id}, counts ? said.value : kGap);
        } else if (std::exchange(said.kept, false)) {
            handlers_.drop({name, id});
        }
    }
    std::erase_if(board.wants, [&](const auto& want) { return !demanded.contains(want.first); });
    for (const auto& service : demanded)
        if (!board.wants.contains(service))
            board.wants[service] = demander_.want(name, service, options_.demand_hz);
}

void ValueChoice::values(const std::string& name, std::string_view payload) {
    const auto found = boards_.find(name);
    if (found == boards_.end()) return;
    auto& board = found->second;
    auto document = property::parse_values(payload);
    if (!payload.empty() && (!document || document->head.board != name)) {
        for (auto& [id, said] : board.said)
            said.value = kGap;
        return apply(name, board);
    }
    // What the agent says no longer leaves.
    auto before = std::exchange(board.said, {});
    if (document) {
        board.head = std::move(document->head);
        for (const auto& [id, shown] : document->values) {
            const bool known = shown.how != property::How::kNone;
            const auto value = known ? number_of_value(shown.value) : kGap;
            if (!value) continue;
            if (auto said = before.extract(id)) board.said.insert(std::move(said));
            board.said[id].value = *value;
        }
    }
    for (const auto& [id, said] : before)
        if (said.kept) handlers_.drop({name, id});
    // Another agent, of which the description may have come already.
    if (board.session != board.head.session) return look(name);
    apply(name, board);
}

void ValueChoice::tick(Time now) {
    for (std::size_t i = 0; i < kMaxLooks && !to_look_.empty(); ++i)
        look(to_look_.extract(to_look_.begin()).value());
    for (auto& message : demander_.due(now))
        port_.publish(std::move(message));
}

}  // namespace asip::registry
