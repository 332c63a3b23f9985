// SPDX-License-Identifier: Apache-2.0
#include "asip/links/sources.hpp"

#include <algorithm>

#include "asip/links/link.hpp"
#include "asip/model/board_state.hpp"
#include "asip/model/json.hpp"
#include "asip/property/value.hpp"

namespace asip::links {
namespace {

using bus::TopicKind;
using nlohmann::json;
using property::Kind;
using property::Property;

// A report is newer than a document that comes within this time: documents wait, and take another way.
constexpr Duration kReportsFirst = std::chrono::seconds(2);

bool flows(const Property& property) {
    return property::is_reported(property) && property.kind != Kind::kBinarySensor &&
           property.kind != Kind::kSwitch;
}

std::optional<bool> state_of(const std::optional<json>& value) {
    return value ? on_of(*value) : std::nullopt;
}

}  // namespace

Sources::Sources(const bus::Topics& topics, const std::string& user, const std::string& client,
                 const Random& random)
    : topics_(topics), demander_(topics, user, client, random), view_(topics) {}

Sources::Tolds Sources::want(const std::set<Id>& sources, Time now) {
    Tolds told;
    ++changes_;
    std::set<std::string> names;
    for (const auto& [name, id] : sources) {
        names.insert(name);
        boards_[name].known.try_emplace(id);
    }
    std::erase_if(boards_, [&](const auto& each) { return !names.contains(each.first); });
    for (auto& [name, board] : boards_) {
        std::erase_if(board.known, [&](const auto& each) { return !sources.contains({name, each.first}); });
        use(name, board, std::move(board.properties));
        if (board.present) tell(name, board, now, true, told);
    }
    return told;
}

std::set<std::string> Sources::filters() const {
    std::set<std::string> filters;
    for (const auto& [name, board] : boards_) {
        const bool demands = std::any_of(board.known.begin(), board.known.end(), [](const auto& each) {
            return static_cast<bool>(each.second.want);
        });
        if (demands || !board.is_local) filters.insert(topics_.description(name));
        if (board.is_local) continue;
        filters.insert({topics_.state(name), topics_.properties(name), topics_.values(name)});
        for (const auto& [id, known] : board.known)
            filters.insert(topics_.service_out(name, property::service_of(id)));
    }
    return filters;
}

void Sources::use(const std::string& name, Board& board, std::vector<Property> properties) {
    board.properties = std::move(properties);
    for (auto& [id, known] : board.known) {
        known.property = find(board.properties, id);
        const bool wanted = static_cast<bool>(known.want);
        if (known.property == nullptr || !flows(*known.property))
            known.want.reset();
        else if (!known.want)
            known.want = demander_.want(name, known.property->read->service);
        if (static_cast<bool>(known.want) != wanted) ++changes_;
    }
}

Sources::Tolds Sources::take(const mqtt::Message& message, Time now) {
    Tolds told;
    const auto topic = topics_.parse(message.topic);
    const auto found = topic ? boards_.find(topic->board) : boards_.end();
    if (found == boards_.end()) return told;
    auto& [name, board] = *found;
    switch (topic->kind) {
        case TopicKind::kState:
        case TopicKind::kDescription:
            demander_.take(message, now);
            view_.apply(message, now);
            if (!board.is_local) judge(name, board, now, told);
            break;
        case TopicKind::kProperties:
            if (!board.is_local) take_list(name, board, message);
            if (!board.is_local && board.present) tell(name, board, now, true, told);
            break;
        case TopicKind::kValues:
            if (!board.is_local) take_values(name, board, message, now, told);
            break;
        case TopicKind::kServiceOut:
            if (!board.is_local && !message.retain)
                take_report(name, board, topic->service, message, now, told);
            break;
        default:
            break;
    }
    return told;
}

void Sources::judge(const std::string& name, Board& board, Time now, Tolds& told) {
    const auto item = view_.board(name, {now, {}});
    const bool present = item && item->state == model::to_text(model::BoardState::kOnline);
    const bool back = present && !board.present;
    set_present(name, board, present, told);
    if (back) tell(name, board, now, true, told);
}

/// What is not there is not known: once it is back, its last document says how it stands.
void Sources::set_present(const std::string& name, Board& board, bool present, Tolds& told) {
    if (board.present == present) return;
    board.present = present;
    if (!present) {
        board.based = false;
        for (auto& [id, known] : board.known) {
            deliver(name, id, known, std::nullopt, false, told);
            known.reported.reset();
        }
    }
    told.push_back({.kind = Told::Kind::kPresent, .board = name, .is = present});
}

void Sources::take_list(const std::string& name, Board& board, const mqtt::Message& message) {
    auto list = property::parse_list(message.payload);
    if (!list || list->head.board != name) return;
    if (list->head.session == board.list.session ? list->head.seq < board.list.seq
                                                 : list->head.session < board.list.session && message.retain)
        return;
    board.list = std::move(list->head);
    use(name, board, std::move(list->properties));
}

void Sources::take_values(const std::string& name, Board& board, const mqtt::Message& message, Time now,
                          Tolds& told) {
    auto document = property::parse_values(message.payload);
    if (!document || document->head.board != name) return;
    const bool same = document->head.session == board.head.session;
    if (same ? document->head.seq <= board.head.seq
             : document->head.session < board.head.session && message.retain)
        return;
    if (!same) board.last_act = 0, board.based = false;
    board.head = document->head;
    board.values = std::move(*document);
    if (board.present) tell(name, board, now, message.retain, told);
}

/// What the last document says. `past`: what was done with buttons is of before.
void Sources::tell(const std::string& name, Board& board, Time now, bool past, Tolds& told) {
    if (!board.values || board.properties.empty()) return;
    const bool new_session = !board.based;
    const auto acts = property::new_acts(board.values->values, board.last_act);
    board.based = true;
    for (const auto& [id, act] : acts) {
        if (past || new_session || !board.known.contains(id)) continue;
        told.push_back({.kind = Told::Kind::kAct, .board = name, .id = id, .act = act});
    }
    for (auto& [id, known] : board.known) {
        const auto found = board.values->values.find(id);
        if (known.property == nullptr || found == board.values->values.end()) continue;
        const auto& shown = found->second;
        const bool there = shown.how != property::How::kNone && !shown.value.is_null();
        const bool newer = known.value && known.reported && now - *known.reported < kReportsFirst;
        if (there && newer && property::is_reported(*known.property)) continue;
        deliver(name, id, known, there ? std::optional(shown.value) : std::nullopt, !past && !new_session,
                told);
    }
}

void Sources::take_report(const std::string& name, Board& board, std::string_view service,
                          const mqtt::Message& message, Time now, Tolds& told) {
    if (!board.present) return;
    std::optional<json> published;
    for (auto& [id, known] : board.known) {
        if (known.property == nullptr || !property::is_reported(*known.property) ||
            known.property->read->service != service)
            continue;
        if (!published) {
            auto read = model::parse_json(message.payload);
            if (!read) return;
            published = std::move(*read);
        }
        const auto value = property::value_in(*known.property, *published);
        if (!value || value->is_null()) continue;
        known.reported = now;
        deliver(name, id, known, value, true, told);
        if (board.values) board.values->values[id] = {*value, property::How::kReported, {}, 0, {}};
    }
}

/// A property that is on and off is pressed and released like a button, which has acts of its own.
void Sources::deliver(const std::string& name, const std::string& id, Known& known,
                      const std::optional<json>& value, bool edges, Tolds& told) {
    const auto before = state_of(known.value), after = state_of(value);
    if (known.value == value) return;
    known.value = value;
    told.push_back({.board = name, .id = id, .value = value});
    if (!edges || !before || !after || *before == *after || known.property == nullptr ||
        property::is_button(*known.property))
        return;
    const auto act = *after ? property::ButtonAct::kPress : property::ButtonAct::kRelease;
    told.push_back({.kind = Told::Kind::kAct, .board = name, .id = id, .act = act});
}

Sources::Tolds Sources::local(const std::vector<Property>& properties, const property::ValueDocument& values,
                              bool present, Time now) {
    Tolds told;
    const auto found = boards_.find(values.head.board);
    if (found == boards_.end()) return told;
    auto& [name, board] = *found;
    const bool was_local = std::exchange(board.is_local, true);
    if (!was_local) ++changes_;
    if (!was_local || board.head.session != values.head.session) board.last_act = 0, board.based = false;
    board.head = values.head;
    for (auto& [id, known] : board.known)
        known.reported.reset();
    if (board.properties != properties ||
        std::any_of(board.known.begin(), board.known.end(),
                    [](const auto& each) { return each.second.property == nullptr; }))
        use(name, board, properties);
    set_present(name, board, present, told);
    board.values = values;
    if (present) tell(name, board, now, false, told);
    return told;
}

Sources::Tolds Sources::local_gone(const std::string& name) {
    Tolds told;
    const auto found = boards_.find(name);
    if (found == boards_.end() || !found->second.is_local) return told;
    set_present(name, found->second, false, told);
    found->second.is_local = false;
    ++changes_;
    found->second.head = {};
    return told;
}

void Sources::connected(Time now) {
    view_.connected(now);
    demander_.connected(now);
}

Sources::Tolds Sources::disconnected() {
    Tolds told;
    view_.disconnected();
    demander_.disconnected();
    for (auto& [name, board] : boards_)
        if (!board.is_local) set_present(name, board, false, told);
    return told;
}

Sources::Tolds Sources::tick(Time now) {
    Tolds told;
    for (const auto& name : view_.expired(now))
        if (const auto board = boards_.find(name); board != boards_.end() && !board->second.is_local)
            judge(board->first, board->second, now, told);
    return told;
}

std::optional<Time> Sources::next_deadline(bool may_publish) const {
    const auto lease = view_.next_expiry(), demand = may_publish ? demander_.next_deadline() : std::nullopt;
    if (!lease || !demand) return lease ? lease : demand;
    return std::min(*lease, *demand);
}

const std::vector<Property>* Sources::properties(std::string_view name) const {
    const auto found = boards_.find(name);
    return found == boards_.end() || found->second.properties.empty() ? nullptr : &found->second.properties;
}

std::optional<json> Sources::value(const Id& source) const {
    const auto board = boards_.find(source.first);
    if (board == boards_.end()) return std::nullopt;
    const auto known = board->second.known.find(source.second);
    return known == board->second.known.end() ? std::nullopt : known->second.value;
}

bool Sources::is_present(std::string_view name) const {
    const auto found = boards_.find(name);
    return found != boards_.end() && found->second.present;
}

}  // namespace asip::links
