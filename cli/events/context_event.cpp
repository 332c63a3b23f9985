// SPDX-License-Identifier: Apache-2.0
#include "cli/events/context_event.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "asip/bus/pattern.hpp"
#include "asip/bus/request/line_service.hpp"
#include "asip/model/json.hpp"
#include "asip/mqtt/router.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/output.hpp"
#include "cli/text/table.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

std::string_view kind_text(ContextEvent::Kind kind) {
    switch (kind) {
        case ContextEvent::Kind::kValue:
            return "event";
        case ContextEvent::Kind::kError:
            return "error";
        case ContextEvent::Kind::kButton:
            return "button";
        case ContextEvent::Kind::kRaw:
            break;
    }
    return "line";
}

std::string level(const std::string& name) {
    const bool pattern = name.empty() || name.find_first_of("*?") != std::string::npos;
    return pattern ? "+" : name;
}

bool is_letter(const std::string& service) {
    return service.size() == 1 && service != "*" && service != "?";
}

/// Letter of the service that a line is of; 0 for lines of the board itself.
char letter_of(const std::string& line) {
    const bool tagged = line.size() > 1 && (line[0] == '@' || line[0] == '~');
    return tagged && line[1] != '#' ? line[1] : '\0';
}

bool of_service(const ContextEvent& event, const std::string& wanted, const model::Description* description) {
    const auto letter = event.kind == ContextEvent::Kind::kRaw ? letter_of(event.payload) : '\0';
    if (letter != '\0' && wanted == std::string(1, letter)) return true;
    if (event.kind != ContextEvent::Kind::kRaw && bus::matches_pattern(wanted, event.service)) return true;
    if (description == nullptr) return false;
    for (const auto& service : description->services) {
        const bool meant =
            bus::matches_pattern(wanted, service.name) || (is_letter(wanted) && service.id == wanted.front());
        const bool sent = letter != '\0' ? service.id == letter : service.name == event.service;
        if (meant && sent) return true;
    }
    return false;
}

std::string age_text(const ContextEvent& event) {
    return event.age ? "+" + text::duration_text(*event.age) : event.retained ? "retained" : "first";
}

}  // namespace

std::optional<ContextEvent> context_event(const bus::Topics& topics, const std::string& topic,
                                          std::string payload) {
    const auto ref = topics.parse(topic);
    if (!ref || ref->service == bus::kLineService) return std::nullopt;
    ContextEvent event;
    switch (ref->kind) {
        case bus::TopicKind::kServiceOut:
            event.kind = ContextEvent::Kind::kValue;
            break;
        case bus::TopicKind::kServiceError:
            event.kind = ContextEvent::Kind::kError;
            break;
        case bus::TopicKind::kBoardOut:
            event.kind = ContextEvent::Kind::kRaw;
            break;
        default:
            return std::nullopt;
    }
    event.board = ref->board;
    event.service = ref->service;
    event.topic = topic;
    event.payload = std::move(payload);
    return event;
}

namespace {

/// Whether everything that `other` matches `filter` matches, too. No name holds a `*`.
bool covers(const std::string& filter, std::string other) {
    std::replace(other.begin(), other.end(), '+', '*');
    return mqtt::topic_matches(filter, other);
}

}  // namespace

std::vector<std::string> context_filters(const bus::Topics& topics, const std::vector<Target>& targets,
                                         bool raw) {
    std::vector<std::string> all;
    for (const auto& target : targets) {
        const auto board = level(target.board);
        if (raw) {
            all.push_back(topics.board_out(board));
        } else {
            // A letter stands for a service whose name is in its description.
            const auto service = is_letter(target.service) ? "+" : level(target.service);
            all.push_back(topics.service_out(board, service));
            all.push_back(topics.service_error(board, service));
        }
    }
    std::vector<std::string> result;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool covered = [&] {
            for (std::size_t j = 0; j < all.size(); ++j) {
                if (i == j || !covers(all[j], all[i])) continue;
                if (all[i] != all[j] || j < i) return true;
            }
            return false;
        }();
        if (!covered) result.push_back(all[i]);
    }
    return result;
}

bool needs_description(const Target& target, bool raw) {
    return !target.service.empty() && (raw || is_letter(target.service));
}

bool is_wanted(const ContextEvent& event, const std::vector<Target>& targets,
               const model::Description* description) {
    return std::any_of(targets.begin(), targets.end(), [&](const Target& target) {
        if (!bus::matches_pattern(target.board, event.board)) return false;
        return target.service.empty() || of_service(event, target.service, description);
    });
}

std::string event_header(bool with_time, bool with_age, bool colour) {
    const std::string text = (with_time ? "TIME" + std::string(22, ' ') : "") + "SERVICE  " +
                             (with_age ? "     AGE  " : "") + "VALUE";
    return painted(text, Colour::kBold, colour);
}

std::string event_text(const ContextEvent& event, const std::string& said, bool with_time, bool with_age,
                       bool colour) {
    std::string text;
    if (with_time) text += painted(text::iso_time(event.time), Colour::kDim, colour) + "  ";
    text += painted(event.where(), Colour::kCyan, colour) + "  ";
    if (with_age) {
        auto age = age_text(event);
        age.insert(0, age.size() < 8 ? 8 - age.size() : 0, ' ');
        text += painted(age, Colour::kDim, colour) + "  ";
    }
    const bool error = event.kind == ContextEvent::Kind::kError;
    return text + painted((error ? "error " : "") + for_terminal(said), error ? Colour::kRed : Colour::kNone,
                          colour);
}

nlohmann::json event_json(const ContextEvent& event) {
    nlohmann::json object{{"time", text::iso_time(event.time)}, {"board", event.board}};
    if (!event.service.empty()) object["service"] = event.service;
    auto payload = event.kind == ContextEvent::Kind::kRaw ? tl::unexpected<std::string>("")
                                                          : model::parse_json(event.payload);
    object[std::string(kind_text(event.kind))] =
        payload ? std::move(*payload) : nlohmann::json(event.payload);
    if (event.age) object["age"] = std::round(event.age->count() * 1e6) / 1e6;
    if (event.retained) object["retained"] = true;
    return object;
}

std::string event_value(const ContextEvent& event, std::string_view name) {
    if (name == "time") return text::iso_time(event.time);
    if (name == "board") return event.board;
    if (name == "service") return event.service;
    if (name == "where") return event.where();
    if (name == "topic") return event.topic;
    if (name == "kind") return std::string(kind_text(event.kind));
    if (name == "payload") return event.payload;
    if (name == "age") return event.age ? std::to_string(event.age->count()) : "";
    if (name == "data") return event.payload;
    if (!name.starts_with("data.")) return {};
    const auto document = model::parse_json(event.payload);
    return document ? value_at(*document, name.substr(5)) : std::string();
}

std::vector<std::string> event_fields() {
    return {"time", "board", "service", "where", "topic", "kind", "payload", "age", "data"};
}

}  // namespace asip::cli
