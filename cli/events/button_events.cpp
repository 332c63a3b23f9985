// SPDX-License-Identifier: Apache-2.0
#include "cli/events/button_events.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "asip/model/json.hpp"
#include "asip/property/documents.hpp"

namespace asip::cli {

std::vector<ContextEvent> ButtonEvents::take(const mqtt::Message& message) {
    std::vector<ContextEvent> events;
    const auto topic = topics_.parse(message.topic);
    const auto document = property::parse_values(message.payload);
    if (!topic || !document) return events;
    auto& acts = acts_[std::string(topic->board)];
    if (std::exchange(acts.session, document->head.session) != document->head.session) acts.last = 0;
    for (const auto& [id, act] : property::new_acts(document->values, acts.last)) {
        if (message.retain) continue;
        auto& event = events.emplace_back();
        event.kind = ContextEvent::Kind::kButton;
        event.board = topic->board;
        event.service = property::service_of(id);
        event.topic = message.topic;
        event.payload = model::dump_json(nlohmann::json{{id, property::to_text(act)}});
    }
    return events;
}

}  // namespace asip::cli
