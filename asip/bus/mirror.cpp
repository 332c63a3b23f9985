// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/mirror.hpp"

#include <algorithm>

#include "asip/bus/match.hpp"
#include "asip/model/board_state.hpp"
#include "asip/model/names.hpp"
#include "asip/text/printable.hpp"

namespace asip::bus {
namespace {

constexpr std::size_t kMaxServiceNames = 64;

unsigned capabilities_of(const model::Description& description) {
    unsigned all = 0;
    for (const char digit : description.pins.capabilities) {
        if (digit >= '0' && digit <= '7') all |= static_cast<unsigned>(digit - '0');
    }
    return all;
}

std::string kind_of(const model::ServiceInfo& service) {
    if (!service.model.empty()) return service.model.substr(0, service.model.find('@'));
    if (service.own_model) return service.own_model->name;
    return service.id == 0 ? service.name : std::string(1, service.id);
}

/// Whether a board in this state is alive as long as its lease runs.
bool is_alive_word(std::string_view state) {
    return state != "offline" && state != "lost";
}

std::string joined(const std::string& a, const std::string& b) {
    return a.empty() || b.empty() ? a + b : a + " " + b;
}

}  // namespace

std::string Mirror::apply(const std::string& topic, const std::string& payload, bool retained, Time now) {
    const auto ref = topics_.parse(topic);
    if (!ref) {
        if (topic.starts_with(topics_.root() + "/servicebus/") && !payload.empty())
            refuse(topic, "a name that is not valid");
        return {};
    }
    if (ref->kind != TopicKind::kBoardNames && ref->kind != TopicKind::kServiceNames &&
        ref->kind != TopicKind::kState && ref->kind != TopicKind::kDescription) {
        return {};
    }
    const std::string name(ref->kind == TopicKind::kBoardNames ? payload : ref->board);
    if (!model::valid_board_name(name)) return {};
    if (entries_.size() >= kMaxBoards && entries_.count(name) == 0) {
        refuse(topic, "more than " + std::to_string(kMaxBoards) + " boards");
        return {};
    }
    refused_.erase(topic);
    auto& entry = entries_[name];
    if (!retained) entry.heard = now;
    switch (ref->kind) {
        case TopicKind::kBoardNames:
            take_name(entry, now);
            break;
        case TopicKind::kServiceNames:
            take_name(entry, now);
            if (model::valid_name(payload) && entry.service_names.size() < kMaxServiceNames &&
                std::find(entry.service_names.begin(), entry.service_names.end(), payload) ==
                    entry.service_names.end()) {
                entry.service_names.push_back(payload);
            }
            break;
        case TopicKind::kState:
            take_state(topic, entry, payload);
            break;
        default:
            take_description(topic, entry, name, payload, now);
    }
    if (!entry.named && entry.reported.empty() && !entry.description) entries_.erase(name);
    return name;
}

void Mirror::refuse(const std::string& topic, std::string reason) {
    if (refused_.size() < kMaxRefused || refused_.count(topic) != 0) refused_[topic] = std::move(reason);
}

void Mirror::take_name(Entry& entry, Time now) {
    entry.named = true;
    if (!entry.description) entry.lease_end = now + std::chrono::seconds(model::kDefaultLeaseSeconds);
}

void Mirror::take_state(const std::string& topic, Entry& entry, const std::string& payload) {
    if (!payload.empty() && !model::board_state_from_text(payload))
        return refuse(topic, "not a state: " + text::printable(payload));
    entry.reported = payload;
}

void Mirror::take_description(const std::string& topic, Entry& entry, const std::string& name,
                              const std::string& payload, Time now) {
    if (payload.empty()) {
        entry.description.reset();
        entry.document.clear();
        return;
    }
    auto description = model::parse_description(payload);
    if (!description) {
        refuse(topic, description.error());
    } else if (description->board != name) {
        refuse(topic, "describes another board: " + description->board);
    } else {
        entry.lease_end = now + std::chrono::seconds(description->lease);
        entry.description = std::move(*description);
        entry.document = payload;
    }
}

BoardItem Mirror::item(const std::string& name, const Entry& entry, Time now) const {
    BoardItem result;
    if (entry.description) {
        result = board_item(*entry.description, entry.reported);
        result.description = entry.document;
    } else {
        result.board = name;
        result.names_only = entry.named;
        for (const auto& service : entry.service_names) {
            ServiceItem one;
            one.name = one.kind = service;
            result.services.push_back(std::move(one));
        }
        result.state = entry.reported.empty() ? "online" : entry.reported;
    }
    const bool has_lease = entry.description || entry.named;
    if (is_alive_word(result.state) && (!has_lease || now >= entry.lease_end)) result.state = "lost";
    result.reported = entry.reported;
    result.age = entry.heard ? std::chrono::duration<double>(now - *entry.heard).count() : -1;
    for (auto& service : result.services) {
        service.board = name;
        service.state = result.state;
    }
    return result;
}

std::vector<BoardItem> Mirror::boards(Time now) const {
    std::vector<BoardItem> result;
    result.reserve(entries_.size());
    for (const auto& [name, entry] : entries_)
        result.push_back(item(name, entry, now));
    return result;
}

std::optional<BoardItem> Mirror::board(const std::string& name, Time now) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) return std::nullopt;
    return item(name, found->second, now);
}

const model::Description* Mirror::description(const std::string& name) const {
    const auto found = entries_.find(name);
    return found != entries_.end() && found->second.description ? &*found->second.description : nullptr;
}

std::vector<std::string> Mirror::names() const {
    std::vector<std::string> result;
    for (const auto& [name, entry] : entries_)
        result.push_back(name);
    return result;
}

BoardItem board_item(const model::Description& description, std::string reported) {
    BoardItem result;
    result.board = description.board;
    result.state = reported.empty() ? "online" : reported;
    result.reported = std::move(reported);
    result.session = description.session;
    result.seq = description.seq;
    result.lease = description.lease;
    result.chip = description.firmware.chip;
    result.sketch = description.firmware.sketch;
    result.protocol = description.firmware.protocol;
    result.agent = joined(description.agent.host, description.agent.client);
    result.link = joined(description.link.kind, description.link.path);
    result.labels = description.labels;
    for (const auto& service : description.services) {
        ServiceItem one;
        one.board = result.board;
        one.state = result.state;
        one.name = service.name;
        one.kind = kind_of(service);
        one.model = service.model;
        if (service.id != 0) one.id = std::string(1, service.id);
        one.title = service.title;
        one.count = service.count;
        one.period = service.period;
        one.label = description.labels.service(service.name);
        result.services.push_back(std::move(one));
    }
    return result;
}

bool service_matches(const Query& query, const ServiceItem& service, const model::Description* description,
                     const model::ModelSet& models) {
    return matches_service(query, service.name, service.kind, [&](const std::string& unit) {
        const auto* info = description == nullptr ? nullptr : description->service(service.name);
        const auto model = info == nullptr ? models.find(service.name) : model_of(*info, models);
        if (!model) return false;
        const auto units = model::units_of(*model);
        return std::find(units.begin(), units.end(), unit) != units.end();
    });
}

bool board_matches(const Query& query, const BoardItem& board, const model::Description* description,
                   const model::ModelSet& models) {
    const unsigned capabilities = description == nullptr ? 0 : capabilities_of(*description);
    if (!matches_board(
            query, {board.board, board.state, board.chip, board.sketch, capabilities, &board.labels.labels}))
        return false;
    if (!asks_for_services(query)) return true;
    return std::any_of(board.services.begin(), board.services.end(), [&](const ServiceItem& service) {
        return service_matches(query, service, description, models);
    });
}

model::ModelPtr model_of(const model::ServiceInfo& service, const model::ModelSet& models) {
    if (service.own_model) return service.own_model;
    if (!service.model.empty()) {
        if (auto exact = models.find_ref(service.model)) return exact;
        return models.find(service.model.substr(0, service.model.find('@')));
    }
    if (service.id == 0) return models.find(service.name);
    return nullptr;
}

}  // namespace asip::bus
